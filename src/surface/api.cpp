#include "surface/api.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "surface/closest.h"
#include "surface/import.h"
#include "surface/maps.h"
#include "surface/ray.h"
#include "surface/recipes/builtin.h"

namespace intaglio {

namespace {

surface::Edge edge_of(const SurfaceOptions& options) {
  return options.edge == Edge::wrap ? surface::Edge::wrap : surface::Edge::clamp;
}

surface::ImportOptions import_options(const SurfaceOptions& options) {
  surface::ImportOptions out;
  out.allowed_memory = options.allowed_memory;
  if (options.green)
    out.green = *options.green == GreenChannel::plus_y ? surface::Green::plus_y : surface::Green::minus_y;
  if (options.white)
    out.polarity = *options.white == WhiteMeans::deep ? surface::Polarity::depth : surface::Polarity::height;
  if (options.depth) out.depth_fraction = *options.depth / options.size.x();
  out.mode = options.mode == ImportMode::fused ? surface::ImportMode::fused : surface::ImportMode::raw;
  out.edge = edge_of(options);
  out.generated_size = options.generated_size;
  return out;
}

Result<void> check(const SurfaceOptions& options) {
  if (!(options.size.minCoeff() > 0) || !options.size.allFinite())
    return fail("SurfaceOptions::size", "is not a size", "both sides must be finite and above 0 m");
  if (options.depth && !(*options.depth >= 0 && std::isfinite(*options.depth)))
    return fail("SurfaceOptions::depth", "is not a depth", "it must be finite and 0 m or more");
  return {};
}

// Slopes of a height in metres: central differences, one-sided at a border that does not repeat.
surface::Slopes slopes_of(const surface::Field& height, const SurfaceOptions& options) {
  const surface::Grid grid{height.width, height.height, edge_of(options)};
  const double du = options.size.x() / grid.width, dv = options.size.y() / grid.height;
  surface::Slopes slopes{surface::Field(grid.width, grid.height), surface::Field(grid.width, grid.height)};
  const auto slope = [&](int i0, int j0, int i1, int j1, double distance) {
    return float((double(height.value[grid.index(i1, j1)]) - double(height.value[grid.index(i0, j0)])) /
                 distance);
  };
  const auto steps = [&](int i, int n) {
    return options.edge == Edge::clamp ? std::max(1, (i > 0) + (i + 1 < n)) : 2;
  };
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i) {
      slopes.x.at(i, j) = slope(i - 1, j, i + 1, j, steps(i, grid.width) * du);
      slopes.y.at(i, j) = slope(i, j - 1, i, j + 1, steps(j, grid.height) * dv);
    }
  }
  return slopes;
}

Surface placed(Surface::Impl impl, surface::Texels texels, double depth, const SurfaceOptions& options) {
  const surface::Placement place(options.pose.position, options.pose.orientation, options.size.x(),
                                 options.size.y());
  impl.pose = options.pose;
  impl.surface = std::make_shared<const surface::Surface>(std::move(texels), place, depth, edge_of(options));
  return Surface(std::make_shared<const Surface::Impl>(std::move(impl)));
}

}  // namespace

Result<Surface> Surface::load(const std::filesystem::path& texture, const SurfaceOptions& options) {
  if (const auto checked = check(options); !checked) return tl::unexpected(checked.error());
  const auto recipe = surface::find_recipe(texture.string());
  if (!recipe) return tl::unexpected(recipe.error());
  Impl impl;
  if (*recipe) {
    const int size = options.generated_size;
    if (auto checked = surface::check_texture_size(size, "SurfaceOptions::generated_size"); !checked)
      return tl::unexpected(checked.error());
    const surface::BuiltinMaterial& about = (*recipe)->about;
    impl.material = about.material;
    impl.roughness = about.roughness;
    surface::Texels texels = surface::to_texels(surface::make_texture(**recipe, size));
    const double depth = about.depth_fraction * options.size.x();
    if (options.depth) surface::rescale_normals(texels.normal, *options.depth / depth);
    return placed(std::move(impl), std::move(texels), options.depth.value_or(depth), options);
  }
  auto imported = surface::import_texture(texture, import_options(options));
  if (!imported) return tl::unexpected(imported.error());
  impl.material = *find_material("brick");
  impl.notes = std::move(imported->notes);
  impl.warnings = std::move(imported->warnings);
  return placed(std::move(impl), std::move(imported->texels), imported->depth_fraction * options.size.x(),
                options);
}

Result<Surface> Surface::from_heights(int width, int height, std::span<const float> heights,
                                      const SurfaceOptions& options) {
  if (const auto checked = check(options); !checked) return tl::unexpected(checked.error());
  if (width < 1 || height < 1 || heights.size() != std::size_t(width) * std::size_t(height))
    return fail("Surface::from_heights", "the heights are not width x height", "give one for each texel");
  if (!std::all_of(heights.begin(), heights.end(), [](float h) { return std::isfinite(h); }))
    return fail("Surface::from_heights", "a height is not finite");
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double range = double(*high) - double(*low);
  surface::Field above(width, height);
  std::copy(heights.begin(), heights.end(), above.value.begin());
  surface::Texels texels;
  texels.width = width;
  texels.height = height;
  texels.normal = surface::normals_of(slopes_of(above, options));
  texels.depth.resize(heights.size());
  for (std::size_t k = 0; k < heights.size(); ++k)
    texels.depth[k] = range > 0 ? float((double(*high) - double(heights[k])) / range) : 0.0f;
  texels.colour = surface::default_colour();
  Impl impl;
  impl.material = *find_material("brick");
  return placed(std::move(impl), std::move(texels), range, options);
}

std::string Surface::import_report() const {
  std::string report;
  for (const std::string& note : impl_->notes) report += note + '\n';
  for (const std::string& warning : impl_->warnings) report += "warning: " + warning + '\n';
  if (!report.empty()) report.pop_back();
  return report;
}

const std::vector<std::string>& Surface::notes() const {
  return impl_->notes;
}
const std::vector<std::string>& Surface::warnings() const {
  return impl_->warnings;
}
const Material& Surface::material() const {
  return impl_->material;
}

Vec2 Surface::size() const {
  return impl_->surface->placement().size();
}
Pose Surface::pose() const {
  return impl_->pose;
}
double Surface::depth() const {
  return impl_->surface->has_depth() ? impl_->surface->max_depth() : 0;
}
int Surface::texels_u() const {
  return impl_->surface->width();
}
int Surface::texels_v() const {
  return impl_->surface->height();
}
bool Surface::has_depth() const {
  return impl_->surface->has_depth();
}
Image8 Surface::colour() const {
  return impl_->surface->colour();
}
std::size_t Surface::memory_bytes() const {
  return impl_->surface->memory_bytes();
}

SurfaceSample Surface::sample(const Vec2& uv, double footprint) const {
  const surface::Sample s = impl_->surface->sample(uv, footprint);
  return {-s.depth, s.normal, s.gradient, s.roughness};
}
double Surface::height(const Vec2& uv, double footprint) const {
  return sample(uv, footprint).height;
}
Vec2 Surface::slope(const Vec2& uv, double footprint) const {
  return sample(uv, footprint).slope;
}
Vec3 Surface::normal(const Vec2& uv, double footprint) const {
  return impl_->surface->placement().direction_to_world(sample(uv, footprint).normal);
}
SmoothHeight Surface::smooth(const Vec2& uv, double footprint) const {
  const surface::SmoothHeight s = impl_->surface->smooth(uv, footprint);
  return {s.height, s.gradient};
}

Vec3 Surface::point(const Vec2& uv) const {
  const surface::Placement& place = impl_->surface->placement();
  return place.to_world({uv.x() * place.size_u(), uv.y() * place.size_v(), height(uv)});
}
Vec2 Surface::uv(const Vec3& point) const {
  const surface::Placement& place = impl_->surface->placement();
  return place.uv(place.to_local(point));
}
bool Surface::covers(const Vec3& point) const {
  const surface::Placement& place = impl_->surface->placement();
  return place.covers(place.to_local(point));
}

std::optional<RayHit> Surface::ray(const Vec3& origin, const Vec3& direction, double t_max) const {
  const surface::Placement& place = impl_->surface->placement();
  const auto hit = surface::intersect(*impl_->surface, place.to_local(origin),
                                      place.direction_to_local(direction), 0, t_max);
  if (!hit) return std::nullopt;
  return RayHit{hit->t, place.to_world(hit->point), place.direction_to_world(hit->normal),
                place.uv(hit->point)};
}

std::optional<ClosestPoint> Surface::closest(const Vec3& point) const {
  const surface::Placement& place = impl_->surface->placement();
  const auto found = surface::closest_point(*impl_->surface, place.to_local(point));
  if (!found) return std::nullopt;
  return ClosestPoint{found->distance, place.to_world(found->point),
                      place.direction_to_world(found->direction), place.uv(found->point)};
}

std::vector<std::string> builtin_textures() {
  return surface::builtin_names();
}

}  // namespace intaglio
