#include "evaluate/picture_truth.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/flip.h"
#include "render/renderer.h"
#include "surface/recipes/builtin.h"

namespace intaglio::evaluate {

namespace {

constexpr double radians = std::numbers::pi / 180;
constexpr std::array<double, 3> elevations = {75, 40, 12};  // degrees
constexpr double azimuth = 25;                              // degrees: no row of a texture is seen end on
constexpr int supersample = 2;
constexpr int mesh_cells = 1024;
constexpr int grid_columns = 96;

// Picture coordinates of a world point, -1 to 1 within the picture.
Vec2 projected(const render::Camera& camera, double aspect, const Vec3& world) {
  const render::CameraBasis basis = render::basis_of(camera);
  const Vec3 w = world - camera.eye;
  const double depth = -w.dot(basis.back);
  if (!(depth > 0)) return Vec2::Constant(std::numeric_limits<double>::infinity());
  const double half = std::tan(0.5 * camera.fov_y_degrees * radians);
  return Vec2(w.dot(basis.right) / aspect, w.dot(basis.up)) / (half * depth);
}

// From that far away; clip distances enclose the slab.
render::Camera camera_from(double elevation, double distance, double side) {
  const double up = elementary::sin(elevation * radians), along = elementary::cos(elevation * radians);
  render::Camera camera;
  camera.eye = distance * Vec3(along * elementary::sin(azimuth * radians), up,
                               along * elementary::cos(azimuth * radians));
  camera.fov_y_degrees = 30;
  camera.near = std::max(distance - side, 0.01 * side);
  camera.far = distance + side;
  return camera;
}

// The nearest camera that has the whole slab in view.
render::Camera view_of_slab(const surface::Placement& place, double thickness, double elevation,
                            double aspect) {
  const double side = place.size().maxCoeff();
  const auto shows_all = [&](double distance) {
    const render::Camera camera = camera_from(elevation, distance, side);
    for (int k = 0; k < 8; ++k) {
      const Vec3 local((k & 1) ? place.size_u() : 0, (k & 2) ? place.size_v() : 0, (k & 4) ? -thickness : 0);
      if ((projected(camera, aspect, place.to_world(local)).array().abs() > 0.97).any()) return false;
    }
    return true;
  };
  double low = 0.1 * side, high = 20 * side;
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    (shows_all(middle) ? high : low) = middle;
  }
  return camera_from(elevation, high, side);
}

// The reference as a surface, for meshes: their vertices lie between four of its texels.
std::shared_ptr<const surface::Surface> surface_of(const Reference& truth, const surface::Surface& like) {
  const int n = std::max(mesh_cells, truth.grid());
  surface::Texels texels;
  texels.width = texels.height = n;
  texels.colour = like.colour();
  const double depth = truth.depth();
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Vec2 p = Vec2(i + 0.5, j + 0.5).cwiseProduct(truth.size()) / n;
      const Vec2 slope = truth.slope(p);
      texels.depth.push_back(depth > 0 ? float(std::clamp(-truth.height(p) / depth, 0.0, 1.0)) : 0);
      texels.normal.push_back(Vec3(-slope.x(), -slope.y(), 1).normalized());
    }
  }
  return std::make_shared<const surface::Surface>(std::move(texels), like.placement(), depth, like.edge());
}

render::RendererOptions renderer_options(const Subject& subject, const Candidate& candidate,
                                         const DepthGrid& grid) {
  render::RendererOptions options;
  options.width = grid.width;
  options.height = grid.height;
  options.supersample = grid.supersample;
  options.slab_thickness = subject.scene(candidate).surface.thickness;
  options.roughness = subject.surface(candidate).roughness;
  options.displaced_mesh_cells = candidate.mesh_cells;
  if (candidate.is_papers) options.march = render::March::classic;
  return options;
}

std::vector<Picture> draw_views(render::Renderer& renderer, const Subject& subject,
                                const Candidate& candidate, std::span<const render::Camera> views) {
  std::vector<Picture> pictures;
  render::FrameScene frame;
  frame.representation = candidate.representation;
  frame.light.direction = subject.scene(candidate).light;
  for (const render::Camera& camera : views) {
    frame.camera = camera;
    Image8 image = renderer.draw(frame);
    pictures.push_back({std::move(image), renderer.depth()});
  }
  return pictures;
}

// A ray in local coordinates: its parameter is the depth along the camera's axis.
struct LocalRay {
  Vec3 origin, direction;
};

// The first t at which the ray meets the reference from above, within its rectangle.
double meet_top(const Reference& reference, const LocalRay& ray) {
  constexpr double nothing = std::numeric_limits<double>::infinity();
  const Vec3& o = ray.origin;
  const Vec3& d = ray.direction;
  // Catmull-Rom overshoots by 9/32 of the range; an image's reference is interpolated twice.
  const double slack = 0.8 * reference.depth() + 1e-4 * reference.size().maxCoeff();
  const Vec3 low(0, 0, -reference.depth() - slack);
  const Vec3 high(reference.size().x(), reference.size().y(), slack);
  double from = 0, to = nothing;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (o[k] < low[k] || o[k] > high[k]) return nothing;
      continue;
    }
    const double a = (low[k] - o[k]) / d[k], b = (high[k] - o[k]) / d[k];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (!(from < to)) return nothing;
  const auto above = [&](double t) {
    const Vec3 p = o + t * d;
    return p.z() - reference.height(p.head<2>());
  };
  if (above(from) <= 0) return nothing;  // a side of the slab
  const double across = d.head<2>().norm() / reference.spacing().minCoeff();
  const double down = std::abs(d.z()) / (high.z() - low.z());
  const double stride = 1 / std::max(2 * across, 64 * down);
  for (double over = from, under; over < to; over = under) {
    under = std::min(over + stride, to);
    if (above(under) > 0) continue;
    for (int step = 0; step < 40; ++step) {
      const double middle = 0.5 * (over + under);
      (above(middle) > 0 ? over : under) = middle;
    }
    return under;
  }
  return nothing;
}

}  // namespace

std::vector<double> reference_depths(const Reference& reference, const surface::Placement& placement,
                                     const render::Camera& camera, const DepthGrid& grid) {
  const render::CameraBasis basis = render::basis_of(camera);
  const double half = std::tan(0.5 * camera.fov_y_degrees * radians);
  const double aspect = double(grid.width) / grid.height;
  const int s = grid.supersample;
  const double right = (s / 2 + 0.5) / s, below = 1 - right;  // of the sample, in its pixel
  const Vec3 eye = placement.to_local(camera.eye);
  const auto depth_at = [&](double x, double y) {
    const Vec3 direction = -basis.back + (2 * x / grid.width - 1) * half * aspect * basis.right +
                           (1 - 2 * y / grid.height) * half * basis.up;
    return meet_top(reference, {eye, placement.direction_to_local(direction)});
  };
  const double jump = 0.1 * reference.depth() + 1e-3 * reference.size().maxCoeff();
  const double reach = 0.5 / s;
  std::vector<double> depths;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const double x = column * grid.stride + grid.stride / 2 + right;
      const double y = row * grid.stride + grid.stride / 2 + below;
      double depth = depth_at(x, y);
      for (const double across : {-reach, reach}) {
        if (!std::isfinite(depth)) break;
        const double bend = depth_at(x + across, y + reach) + depth_at(x - across, y - reach) - 2 * depth;
        if (!(std::abs(bend) < jump)) depth = std::numeric_limits<double>::infinity();
      }
      depths.push_back(depth);
    }
  }
  return depths;
}

Result<PictureReference> PictureReference::make(const Subject& subject, int pixels) {
  if (pixels < 64)
    return fail("pictures", fmt::format("are {} pixels wide", pixels), "they must be at least 64");
  PictureReference out;
  out.grid_ = {.width = pixels,
               .height = (9 * pixels + 8) / 16,
               .supersample = supersample,
               .stride = std::max(1, pixels / grid_columns)};
  Candidate candidate = candidates()[std::size_t(Kind::relief)];
  candidate.mesh_cells = mesh_cells;
  const Reference& truth = subject.reference();
  out.surface_ = surface_of(truth, *subject.surface(candidate).surface);
  const render::RendererOptions options = renderer_options(subject, candidate, out.grid_);
  auto renderer = render::Renderer::create(*out.surface_, options);
  if (!renderer) return tl::unexpected(renderer.error());
  const surface::Placement& place = out.surface_->placement();
  for (const double elevation : elevations) {
    out.views_.push_back(
        view_of_slab(place, options.slab_thickness, elevation, double(out.grid_.width) / out.grid_.height));
    out.depths_.push_back(reference_depths(truth, place, out.views_.back(), out.grid_));
  }
  out.pictures_ = draw_views(**renderer, subject, candidate, out.views_);
  return out;
}

const surface::Surface& PictureReference::drawn(const Subject& subject, const Candidate& candidate) const {
  return candidate.mesh_cells > 0 ? *surface_ : *subject.surface(candidate).surface;
}

Result<PictureTruth> PictureReference::compare(std::span<const Picture> pictures) const {
  double depth_sum = 0, flip_sum = 0;
  std::size_t both = 0, shown = 0;
  PictureTruth truth;
  for (std::size_t view = 0; view < views_.size(); ++view) {
    const Picture& reference = pictures_[view];
    const Picture& picture = pictures[view];
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = 0; column < grid_.columns(); ++column) {
        const double there = depths_[view][std::size_t(row * grid_.columns() + column)];
        const auto here = double(picture.depth[grid_.pixel(column, row)]);
        if (!std::isfinite(there) || !std::isfinite(here)) continue;
        depth_sum += (here - there) * (here - there);
        ++both;
      }
    }
    const auto difference = flip(reference.image, picture.image);
    if (!difference) return tl::unexpected(difference.error());
    std::size_t either = 0, one = 0;
    for (std::size_t p = 0; p < picture.depth.size(); ++p) {
      const bool in_reference = std::isfinite(reference.depth[p]),
                 in_picture = std::isfinite(picture.depth[p]);
      if (!in_reference && !in_picture) continue;
      ++either;
      one += in_reference != in_picture;
      flip_sum += double(difference->error.data[p]);
    }
    shown += either;
    truth.silhouette = double(one) / double(std::max<std::size_t>(either, 1));  // the last view grazes
  }
  truth.depth_mm = 1000 * std::sqrt(depth_sum / double(std::max<std::size_t>(both, 1)));
  truth.flip = flip_sum / double(std::max<std::size_t>(shown, 1));
  return truth;
}

double normal_angle(const Reference& reference, const Sight& sight) {
  constexpr int points = 4096, samples = 4;  // samples a side of each square
  const Vec2 square = reference.size() * (2.0 / surface::default_texture_size);
  double sum = 0;
  for (int i = 0; i < points; ++i) {
    // Roberts's sequence, even but without a period: a grid of points would miss the joints of a grid of
    // tiles. Its steps are 1 / g and 1 / g^2 with g^3 = g + 1.
    const Vec2 uv(std::fmod(0.5 + i * 0.7548776662466927, 1.0), std::fmod(0.5 + i * 0.5698402909980532, 1.0));
    const Vec2 corner = uv.cwiseProduct(reference.size()) - 0.5 * square;
    Vec2 seen = Vec2::Zero(), there = Vec2::Zero();
    for (int k = 0; k < samples * samples; ++k) {
      const Vec2 p = corner + Vec2(k % samples + 0.5, k / samples + 0.5).cwiseProduct(square) / samples;
      seen += sight.slope({p.x(), p.y(), reference.height(p)});
      there += reference.slope(p).cwiseMax(-Sight::steepest).cwiseMin(Sight::steepest);
    }
    const double mean = 1.0 / (samples * samples);
    const Vec3 a(-mean * seen.x(), -mean * seen.y(), 1), b(-mean * there.x(), -mean * there.y(), 1);
    sum += elementary::atan2(a.cross(b).norm(), a.dot(b)) / radians;
  }
  return sum / points;
}

Result<PictureTruth> measure_picture(const Subject& subject, const Candidate& candidate, const Sight& sight,
                                     const PictureReference& reference) {
  const render::RendererOptions options = renderer_options(subject, candidate, reference.grid());
  auto renderer = render::Renderer::create(*subject.surface(candidate).surface, options);
  if (!renderer) return tl::unexpected(renderer.error());
  // The reference's own textures, which are larger, are not a mesh's cost.
  const render::Renderer::DeviceBytes bytes = (*renderer)->device_bytes();
  if (candidate.mesh_cells > 0) {
    const std::array<render::SurfacePart, 1> part = {{{.surface = &reference.drawn(subject, candidate),
                                                       .slab_thickness = options.slab_thickness,
                                                       .roughness = options.roughness,
                                                       .displaced_mesh_cells = candidate.mesh_cells}}};
    if (auto shown = (*renderer)->show(part); !shown) return tl::unexpected(shown.error());
  }
  auto truth = reference.compare(draw_views(**renderer, subject, candidate, reference.views()));
  if (!truth) return truth;
  truth->normal_angle = normal_angle(subject.reference(), sight);
  truth->device_bytes = bytes.textures + bytes.meshes;
  return truth;
}

}  // namespace intaglio::evaluate
