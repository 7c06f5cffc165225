#include "contact/curved_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "contact/curved_contacts.h"
#include "contact/leaf_walk.h"
#include "contact/query.h"
#include "mesh/relief_closest.h"
#include "mesh/relief_minimum.h"
#include "surface/closest.h"
#include "surface/surface.h"

namespace intaglio::contact {

namespace {

using surface::LinearPiece;
using surface::MeshFeature;
using surface::ReliefMesh;
using surface::ReliefPiece;

constexpr double out_of_reach = std::numeric_limits<double>::infinity();

// Local minima of the distance of a body's pieces to a ground; a visitor of ReliefMesh::visit_pieces.
//
// A Ground provides
//   Candidates& found;   double texel_size();
//   double lower_bound(const surface::Bounds&), lower_bound(const LinearPiece&)   of the distance
//   bool is_near(const LinearPiece&)                a closer test, for a piece of a texel's size
//   closest(const Vec3& body_point)                 an optional feature: point, direction, distance
//   Vec3 to_body(const Vec3&), to_ground(const Vec3&)                          directions
//   Vec2 start(const ReliefPiece&)                  the weights to begin with
//   void add(const ReliefPiece&, const Vec2& weights, const feature&)
template <class Ground>
class MinimumSearch {
 public:
  explicit MinimumSearch(Ground& ground) : ground_(ground), tolerance_(1e-12 * ground.texel_size()) {}

  double limit() const { return ground_.found.search_limit(); }
  double lower_bound(const surface::Bounds& box) const { return ground_.lower_bound(box); }
  double lower_bound(const LinearPiece& piece) const { return ground_.lower_bound(piece); }
  void visit(const ReliefPiece& piece) { subdivide(piece, piece.linear(), 16); }

 private:
  // Into pieces at most as large as the ground's texels.
  void subdivide(const ReliefPiece& piece, const LinearPiece& linear, int subdivisions) {
    if (subdivisions == 0 || linear.radius() <= ground_.texel_size()) {
      if (ground_.is_near(linear)) minimise(piece);
      return;
    }
    piece.for_each_half(linear.longer_axis(), [&](const ReliefPiece& half) {
      const LinearPiece own = half.linear();
      if (ground_.lower_bound(own) < limit()) subdivide(half, own, subdivisions - 1);
    });
  }

  // Alternating minimisation; adds the local minimum that it reaches.
  void minimise(const ReliefPiece& piece) {
    Vec2 at = ground_.start(piece);
    auto nearest = ground_.closest(piece.point(at));
    if (!nearest) return;
    for (int iteration = 0; iteration < 8; ++iteration) {
      const Vec3 direction = ground_.to_body(nearest->direction);
      const surface::PlaneDistance plane{direction, direction.dot(piece.point(at))};
      surface::PieceMinimiser<surface::PlaneDistance> minimiser(piece, plane, -tolerance_);
      if (!minimiser.run()) break;
      // Halve the step while it does not reduce the distance.
      Vec2 next = minimiser.best().weights;
      bool is_better = false;
      for (int half = 0; half < 6 && !is_better; ++half) {
        const auto there = ground_.closest(piece.point(next));
        is_better = there && there->distance < nearest->distance - tolerance_;
        if (is_better) {
          nearest = there;
          at = next;
        }
        next = 0.5 * (next + at);
      }
      if (!is_better) break;
    }
    // Reject pairs whose outer sides do not face each other: the body is below the ground, or behind it.
    if (ground_.to_ground(piece.base_normal(at)).dot(nearest->direction) < 0)
      ground_.add(piece, at, *nearest);
  }

  Ground& ground_;
  double tolerance_;
};

// A rectangle; the body in its local frame.
struct RectangleGround {
  const ReliefMesh& body;
  const surface::Surface& surface;
  Frame frame;
  Candidates& found;
  double thickness;
  Vec3 up = frame.axes.transpose() * Vec3::UnitZ();  // in the body's frame

  double texel_size() const { return std::min(surface.texel_u(), surface.texel_v()); }

  double lower_bound(const surface::Bounds& box) const {
    const Vec3 middle = frame(box.center());
    const Vec3 half = frame.axes.cwiseAbs() * (0.5 * box.sizes());
    return bound({middle.head<2>() - half.head<2>(), middle.head<2>() + half.head<2>(), middle.z() - half.z(),
                  middle.z() + half.z()});
  }
  double lower_bound(const LinearPiece& piece) const {
    const Vec3 middle = frame(piece.middle);
    const Vec2 half = Vec2::Constant(piece.radius());
    return bound({middle.head<2>() - half, middle.head<2>() + half,
                  middle.z() + piece.min_along(up) - piece.error,
                  middle.z() - piece.min_along(-up) + piece.error});
  }
  // As lower_bound, with the ground's own extent in place of its blocks'.
  bool is_near(const LinearPiece& piece) const {
    const Vec3 middle = frame(piece.middle);
    const Vec2 half = Vec2::Constant(piece.radius() + found.max_distance());
    const auto uv = [&](const Vec2& at) { return surface.placement().uv({at.x(), at.y(), 0}); };
    const double top = height_range(surface, uv(middle.head<2>() - half), uv(middle.head<2>() + half)).high;
    return middle.z() + piece.min_along(up) - piece.error - top < found.search_limit();
  }

  std::optional<surface::Feature> closest(const Vec3& body_point) const {
    return closest_point(surface, frame(body_point));
  }
  Vec3 to_body(const Vec3& direction) const { return frame.axes.transpose() * direction; }
  Vec3 to_ground(const Vec3& direction) const { return frame.axes * direction; }

  // The corner with the least gap, or the centroid.
  Vec2 start(const ReliefPiece& piece) const {
    const auto gap = [&](const Vec2& weights) {
      const Vec3 local = frame(piece.point(weights));
      return local.z() + surface.depth(surface.placement().uv(local));
    };
    Vec2 at = piece.outline.centroid();
    double lowest = gap(at);
    for (const Vec2& corner : piece.outline) {
      const double next = gap(corner);
      if (next >= lowest) continue;
      lowest = next;
      at = corner;
    }
    return at;
  }

  void add(const Candidate& c) const {
    if (c.distance >= -thickness) found.add(c);
  }
  void add(const ReliefPiece& piece, const Vec2& at, const surface::Feature& nearest) const {
    if (!surface.placement().covers(nearest.point)) return;
    add({nearest.point, nearest.direction, nearest.distance,
         feature(piece.triangle.index, at, nearest.cell_i, nearest.cell_j)});
  }
  std::uint64_t feature(int triangle, const Vec2& weights, int i, int j) const {
    const auto cell = std::uint64_t(std::uint32_t(i)) << 32 | std::uint32_t(j);
    return internal::curved_feature_id(body, triangle, weights, BodyFeature::face, 0, 0) ^
           (cell * 0x9e3779b97f4a7c15ull);
  }

 private:
  struct Region {
    Vec2 low, high;  // in plan
    double bottom, top;
  };
  // A lower bound of the distance of what is in a region, as far as it is within the limit.
  double bound(const Region& region) const {
    // Behind a ground of finite thickness is not below it.
    if (region.top < -surface.max_depth() - thickness) return out_of_reach;
    const double reach = found.max_distance();
    if (is_beside(surface.placement(), region.low, region.high, reach) || region.bottom > reach)
      return out_of_reach;
    const Vec2 margin = Vec2::Constant(reach);
    return region.bottom - range_over(surface, region.low - margin, region.high + margin).high;
  }
};

// On the plane z = 0: the lowest places of the body, a few texels apart.
void add_lowest(const RectangleGround& ground) {
  constexpr std::size_t max_count = 4;
  std::array<MeshFeature, max_count> lowest;
  const double offset = -ground.frame.origin.z();
  for (std::size_t count = 0; count < max_count; ++count) {
    const auto next = lowest_point(ground.body, ground.up, offset, ground.found.search_limit(),
                                   std::span(lowest).first(count), 2 * ground.body.texel_size());
    if (!next) return;
    lowest[count] = *next;
    const Vec3 at = ground.frame(next->point);
    if (!ground.surface.placement().covers(at)) continue;
    ground.add({Vec3(at.x(), at.y(), 0), Vec3::UnitZ(), at.z(),
                ground.feature(next->triangle, next->weights, 0, 0)});
  }
}

// Also tests the ground's texels around the overlaps found, the summits among them: they may be deeper in the
// body.
void add_summits(const RectangleGround& ground) {
  struct Texel {
    int i, j;
  };
  std::array<Texel, 32> texels;
  std::size_t count = 0;
  const surface::Surface& surface = ground.surface;
  for (const Candidate& c : ground.found) {
    if (c.distance >= 0 || count + 4 > texels.size()) continue;
    const auto [i, j] = surface.cell_at(c.point.x(), c.point.y());
    for (int k = 0; k < 4; ++k) {
      const Texel t{i + (k & 1), j + (k >> 1)};
      const bool is_known = std::any_of(texels.begin(), texels.begin() + std::ptrdiff_t(count),
                                        [&](const Texel& o) { return o.i == t.i && o.j == t.j; });
      if (!is_known) texels[count++] = t;
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto [i, j] = texels[k];
    const double z = surface.texel_z(i, j);
    if (surface.texel_z(i - 1, j) + surface.texel_z(i + 1, j) > 2 * z ||
        surface.texel_z(i, j - 1) + surface.texel_z(i, j + 1) > 2 * z)
      continue;
    const Vec3 at((i + 0.5) * surface.texel_u(), (j + 0.5) * surface.texel_v(), z);
    const auto f = closest_point(ground.body, ground.frame.back(at), ground.texel_size());
    if (!f || f->distance >= 0 || !surface.placement().covers(at)) continue;
    const Vec3 normal = ground.frame.axes * -f->direction;
    if (normal.z() > 1e-3)
      ground.add({at, normal, f->distance, ground.feature(f->triangle, f->weights, i, j)});
  }
}

// A relief on a curved base; the body in its frame.
struct MeshGround {
  const Pose& pose;
  const ReliefMesh& relief;
  double depth;
  Candidates& found;

  double texel_size() const { return relief.texel_size(); }

  double lower_bound(const surface::Bounds& box) const {
    return bound(box.center(), 0.5 * box.sizes().norm());
  }
  double lower_bound(const LinearPiece& piece) const {
    return bound(piece.middle, piece.radius() + piece.error);
  }
  bool is_near(const LinearPiece&) const { return true; }

  std::optional<MeshFeature> closest(const Vec3& body_point) const {
    return closest_point(relief, pose.to_world(body_point), depth + 2 * relief.texel_size());
  }
  Vec3 to_body(const Vec3& direction) const { return pose.orientation.conjugate() * direction; }
  Vec3 to_ground(const Vec3& direction) const { return pose.orientation * direction; }
  Vec2 start(const ReliefPiece& piece) const { return piece.outline.centroid(); }

  void add(const ReliefPiece& piece, const Vec2&, const MeshFeature& nearest) const {
    if (nearest.distance < -depth) return;
    const int index = piece.triangle.index;
    found.add({nearest.point, nearest.direction, nearest.distance,
               internal::curved_feature_id(relief, nearest.triangle, nearest.weights, BodyFeature::face,
                                           index & 255, (index >> 8) & 63)});
  }

 private:
  // A lower bound of the distance of what is within `radius` of a point of the body.
  double bound(const Vec3& middle, double radius) const {
    const Vec3 at = pose.to_world(middle);
    const double reach = radius + std::max(found.max_distance(), depth);
    if (relief.bounds().squaredExteriorDistance(at) > reach * reach) return out_of_reach;
    const auto nearest = closest_point(relief, at, reach);
    return nearest ? nearest->distance - radius : out_of_reach;
  }
};

}  // namespace

ContactSet curved_on_relief(const ReliefMesh& body, const Pose& pose, const surface::Surface& ground,
                            double margin, double thickness) {
  ContactSet set;
  if (!is_rigid(pose)) {
    set.status = status::bad_pose;
    return set;
  }
  const surface::Placement& place = ground.placement();
  set.status |= limit_margin(margin, std::min(place.size_u(), place.size_v()));
  const Frame frame = local_frame(place, pose);
  if (is_far(frame.origin, std::max(place.size_u(), place.size_v()))) {
    set.status |= status::far;
    return set;
  }
  if (!(thickness >= 0)) thickness = 0;
  const surface::Bounds bounds = body.bounds();
  const Vec3 middle = frame(bounds.center());
  const Vec2 plan = middle.head<2>();
  const double reach = 0.5 * bounds.sizes().norm() + margin;
  if (is_beside(place, plan, plan, reach)) {
    set.status |= status::off_edge;
    return set;
  }
  if (middle.z() > reach) return set;
  if (middle.z() < -ground.max_depth() - reach) {
    if (std::isinf(thickness)) set.status |= status::under;
    return set;
  }
  Candidates found(margin);
  RectangleGround rectangle{body, ground, frame, found, thickness};
  if (ground.is_flat()) {
    add_lowest(rectangle);
  } else {
    MinimumSearch<RectangleGround> search(rectangle);
    body.visit_pieces(search);
    add_summits(rectangle);
  }
  found.select(ground, set);
  return set;
}

ContactSet curved_on_curved(const ReliefMesh& body, const Pose& pose, const ReliefMesh& ground, double margin,
                            double depth) {
  ContactSet set;
  if (!is_rigid(pose)) {
    set.status = status::bad_pose;
    return set;
  }
  const double side = ground.bounds().sizes().maxCoeff();
  set.status |= limit_margin(margin, side);
  if (is_far(pose.position, side)) {
    set.status |= status::far;
    return set;
  }
  depth = depth > 0 ? std::min(depth, side) : 0;
  Candidates found(margin);
  const Pose unit{pose.position, pose.orientation.normalized()};
  MeshGround mesh{unit, ground, depth, found};
  MinimumSearch<MeshGround> search(mesh);
  body.visit_pieces(search);
  internal::select(ground, found, set);
  return set;
}

}  // namespace intaglio::contact
