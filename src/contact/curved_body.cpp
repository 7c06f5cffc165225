#include "contact/curved_body.h"

#include <algorithm>
#include <cmath>

#include "contact/curved_contacts.h"
#include "contact/leaf_walk.h"
#include "contact/query.h"
#include "mesh/relief_closest.h"
#include "mesh/relief_minimum.h"
#include "surface/closest.h"
#include "surface/surface.h"

namespace intaglio::contact {

namespace {

using surface::FlatPiece;
using surface::MeshFeature;
using surface::ReliefMesh;
using surface::ReliefPiece;

// The body in the ground's local frame.
struct Meeting {
  const ReliefMesh& body;
  const surface::Surface& ground;
  Frame frame;
  Candidates& found;
  double thickness;  // m, of the ground

  double texel() const { return std::min(ground.texel_u(), ground.texel_v()); }
  // Nothing that is nowhere higher than `z`, in the ground's frame, can be within its thickness.
  bool is_behind(double z) const { return z < -ground.max_depth() - thickness; }
  void add(const Candidate& c) const {
    if (c.distance >= -thickness) found.add(c);
  }
  std::uint64_t name(int triangle, const Vec2& weights, int i, int j) const {
    const auto cell =
        static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32 | static_cast<std::uint32_t>(j);
    return curved_feature_id(body, triangle, weights, Part::face, 0, 0) ^ (cell * 0x9e3779b97f4a7c15ull);
  }
};

// On the plane z = 0: the lowest places of the body, a few texels apart.
void on_plane(const Meeting& meeting) {
  constexpr std::size_t most = 4;
  std::array<MeshFeature, most> lowest;
  const Vec3 up = meeting.frame.axes.transpose() * Vec3::UnitZ();
  const double offset = -meeting.frame.origin.z();
  for (std::size_t count = 0; count < most; ++count) {
    const auto next = lowest_point(meeting.body, up, offset, meeting.found.limit() + 1e-300,
                                   std::span(lowest).first(count), 2 * meeting.body.texel());
    if (!next) return;
    lowest[count] = *next;
    const Vec3 at = meeting.frame(next->point);
    if (!meeting.ground.placement().covers(at)) continue;
    meeting.add(
        {Vec3(at.x(), at.y(), 0), Vec3::UnitZ(), at.z(), meeting.name(next->triangle, next->weights, 0, 0)});
  }
}

class GroundSearch {
 public:
  explicit GroundSearch(const Meeting& meeting)
      : meeting_(meeting), up_(meeting.frame.axes.transpose() * Vec3::UnitZ()) {}

  double limit() const { return meeting_.found.limit() + 1e-300; }
  double least(const surface::Box& box) const {
    const Vec3 middle = meeting_.frame(box.center());
    const Vec3 half = meeting_.frame.axes.cwiseAbs() * (0.5 * box.sizes());
    if (meeting_.is_behind(middle.z() + half.z())) return std::numeric_limits<double>::infinity();
    return over_ground(middle.head<2>() - half.head<2>(), middle.head<2>() + half.head<2>(),
                       middle.z() - half.z());
  }
  double least(const FlatPiece& piece) const {
    const Vec3 middle = meeting_.frame(piece.middle);
    if (meeting_.is_behind(middle.z() - piece.least_along(-up_) + piece.play))
      return std::numeric_limits<double>::infinity();
    const Vec2 aside = Vec2::Constant(piece.radius());
    return over_ground(middle.head<2>() - aside, middle.head<2>() + aside,
                       middle.z() + piece.least_along(up_) - piece.play);
  }
  void visit(const ReliefPiece& piece) { descend(piece, 16); }

 private:
  // A lower bound of the distance of what is over low..high and above z, as far as it is within the limit.
  double over_ground(const Vec2& low, const Vec2& high, double z) const {
    const surface::Placement& place = meeting_.ground.placement();
    const double reach = meeting_.found.limit();
    const Vec2 aside = Vec2::Constant(reach);
    if (high.x() < -reach || high.y() < -reach || low.x() > place.size_u() + reach ||
        low.y() > place.size_v() + reach || z > reach)
      return std::numeric_limits<double>::infinity();
    return z - range_over(meeting_.ground, low - aside, high + aside).high;
  }

  // Pieces as large as the ground's texels at most.
  void descend(const ReliefPiece& piece, int cuts) {
    const Vec2 middle = piece.outline.middle();
    const FlatPiece flat(piece.triangle, piece.outline, piece.heights(middle), middle);
    if (!(least(flat) < limit())) return;
    if (cuts == 0 || flat.radius() <= meeting_.texel()) {
      if (is_near(flat)) touch(piece);
      return;
    }
    const Vec2 across = flat.longer_way();
    surface::WeightPolygon below, above;
    piece.outline.split(across, -across.dot(middle), below, above);
    for (const surface::WeightPolygon* half : {&below, &above}) {
      if (half->is_empty()) continue;
      ReliefPiece part = piece;
      part.outline = *half;
      descend(part, cuts - 1);
    }
  }

  // As `least`, with the ground's own extent in place of its blocks'.
  bool is_near(const FlatPiece& piece) const {
    const Vec3 middle = meeting_.frame(piece.middle);
    const Vec2 aside = Vec2::Constant(piece.radius() + meeting_.found.limit());
    const surface::Placement& place = meeting_.ground.placement();
    const auto uv = [&](const Vec2& at) { return place.uv({at.x(), at.y(), 0}); };
    const double top =
        height_range(meeting_.ground, uv(middle.head<2>() - aside), uv(middle.head<2>() + aside)).high;
    return middle.z() + piece.least_along(up_) - piece.play - top < limit();
  }

  double gap(const Vec3& local) const {
    return local.z() + meeting_.ground.depth(meeting_.ground.placement().uv(local));
  }

  // The local minimum of the distance to the ground that turns lead to.
  void touch(const ReliefPiece& piece) {
    Vec2 at = piece.outline.middle();
    double lowest = gap(meeting_.frame(piece.point(at)));
    for (const Vec2& corner : piece.outline) {
      const double next = gap(meeting_.frame(piece.point(corner)));
      if (next >= lowest) continue;
      lowest = next;
      at = corner;
    }
    auto nearest = closest_point(meeting_.ground, meeting_.frame(piece.point(at)));
    if (!nearest) return;
    for (int turn = 0; turn < 8; ++turn) {
      const Vec3 direction = meeting_.frame.axes.transpose() * nearest->direction;
      const surface::PlaneCore core{direction, direction.dot(piece.point(at))};
      surface::PieceMinimiser<surface::PlaneCore> minimiser(piece, core, -1e-12 * meeting_.texel());
      if (!minimiser.run()) break;
      // Half way, and half of that, where the ground's normal turns too soon.
      Vec2 next = minimiser.best().weights;
      bool better = false;
      for (int half = 0; half < 6 && !better; ++half) {
        const auto there = closest_point(meeting_.ground, meeting_.frame(piece.point(next)));
        better = there && there->distance < nearest->distance - 1e-12 * meeting_.texel();
        if (better) {
          nearest = there;
          at = next;
        }
        next = 0.5 * (next + at);
      }
      if (!better) break;
    }
    if (!meeting_.ground.placement().covers(nearest->point)) return;
    // A body that is under the ground is no obstacle to it: its outer side must look at the ground's.
    const Vec3 outwards = meeting_.frame.axes * piece.base_normal(at);
    if (outwards.dot(nearest->direction) >= 0) return;
    meeting_.add({nearest->point, nearest->direction, nearest->distance,
                  meeting_.name(piece.triangle.index, at, nearest->cell_i, nearest->cell_j)});
  }

  const Meeting& meeting_;
  Vec3 up_;
};

// The ground's texels around the deepest places that are deeper in the body than those are in the ground.
void add_texels(const Meeting& meeting) {
  struct Texel {
    int i, j;
  };
  std::array<Texel, 32> texels;
  std::size_t count = 0;
  const surface::Surface& ground = meeting.ground;
  for (const Candidate& c : meeting.found) {
    if (c.distance >= 0 || count + 4 > texels.size()) continue;
    const auto [i, j] = ground.cell_at(c.point.x(), c.point.y());
    for (int k = 0; k < 4; ++k) {
      const Texel t{i + (k & 1), j + (k >> 1)};
      const bool known = std::any_of(texels.begin(), texels.begin() + static_cast<std::ptrdiff_t>(count),
                                     [&](const Texel& o) { return o.i == t.i && o.j == t.j; });
      if (!known) texels[count++] = t;
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto [i, j] = texels[k];
    const double z = ground.texel_z(i, j);
    if (ground.texel_z(i - 1, j) + ground.texel_z(i + 1, j) > 2 * z ||
        ground.texel_z(i, j - 1) + ground.texel_z(i, j + 1) > 2 * z)
      continue;  // no summit
    const Vec3 at((i + 0.5) * ground.texel_u(), (j + 0.5) * ground.texel_v(), z);
    const auto f = closest_point(meeting.body, meeting.frame.back(at), meeting.texel());
    if (!f || f->distance >= 0 || !ground.placement().covers(at)) continue;
    const Vec3 normal = meeting.frame.axes * -f->direction;
    if (normal.z() > 1e-3)
      meeting.add({at, normal, f->distance, meeting.name(f->triangle, f->weights, i, j)});
  }
}

}  // namespace

ContactSet curved_on_relief(const ReliefMesh& body, const Pose& pose, const surface::Surface& ground,
                            double margin, double thickness) {
  ContactSet set;
  if (!is_rigid(pose)) {
    set.status = status::bad_pose;
    return set;
  }
  const surface::Placement& place = ground.placement();
  const double side = std::min(place.size_u(), place.size_v());
  if (!(margin <= side)) set.status |= status::wide_margin;
  margin = margin > 0 ? std::min(margin, side) : 0;
  const Vec3 origin = place.to_local(pose.position);
  if (origin.norm() > 1e5 * std::max(place.size_u(), place.size_v())) {
    set.status |= status::far;
    return set;
  }
  Candidates found(margin);
  const Mat3 turn = pose.orientation.normalized().toRotationMatrix();
  Frame frame{Mat3(), origin};
  for (int k = 0; k < 3; ++k) frame.axes.col(k) = place.direction_to_local(turn.col(k));
  if (!(thickness >= 0)) thickness = 0;
  const Meeting meeting{body, ground, frame, found, thickness};
  const surface::Box bounds = body.bounds();
  const Vec3 middle = frame(bounds.center());
  const double reach = 0.5 * bounds.sizes().norm() + margin;
  if (middle.x() < -reach || middle.y() < -reach || middle.x() > place.size_u() + reach ||
      middle.y() > place.size_v() + reach) {
    set.status |= status::off_edge;
    return set;
  }
  if (middle.z() > reach) return set;
  if (middle.z() < -ground.max_depth() - reach) {
    // What is under the back of a ground is not under the ground.
    if (std::isinf(thickness)) set.status |= status::under;
    return set;
  }
  if (ground.is_flat()) {
    on_plane(meeting);
  } else {
    GroundSearch search(meeting);
    body.walk(search);
    add_texels(meeting);
  }
  if (found.overflowed()) set.status |= status::limit;
  found.choose(ground, set);
  return set;
}

namespace {

using surface::FlatPiece;
using surface::MeshFeature;
using surface::ReliefMesh;
using surface::ReliefPiece;

constexpr double nowhere = std::numeric_limits<double>::infinity();

class MeshSearch {
 public:
  MeshSearch(const Pose& pose, const ReliefMesh& ground, double depth, Candidates& found)
      : pose_(pose), ground_(ground), depth_(depth), found_(found) {}

  double limit() const { return found_.limit() + 1e-300; }
  double least(const surface::Box& box) const { return least(box.center(), 0.5 * box.sizes().norm()); }
  double least(const FlatPiece& piece) const { return least(piece.middle, piece.radius() + piece.play); }
  void visit(const ReliefPiece& piece) {
    const Vec2 middle = piece.outline.middle();
    cut(piece, FlatPiece(piece.triangle, piece.outline, piece.heights(middle), middle), 16);
  }

 private:
  // A lower bound of the distance of what is within `radius` of a point of the body.
  double least(const Vec3& middle, double radius) const {
    const Vec3 at = pose_.to_world(middle);
    const double reach = radius + std::max(found_.limit(), depth_);
    if (ground_.bounds().squaredExteriorDistance(at) > reach * reach) return nowhere;
    const auto nearest = closest_point(ground_, at, reach);
    return nearest ? nearest->distance - radius : nowhere;
  }

  // Into pieces as large as the ground's texels at most.
  void cut(const ReliefPiece& piece, const FlatPiece& flat, int cuts) {
    if (cuts == 0 || flat.radius() <= ground_.texel()) return touch(piece);
    const Vec2 middle = piece.outline.middle();
    const Vec2 across = flat.longer_way();
    surface::WeightPolygon below, above;
    piece.outline.split(across, -across.dot(middle), below, above);
    for (const surface::WeightPolygon* half : {&below, &above}) {
      if (half->is_empty()) continue;
      ReliefPiece part = piece;
      part.outline = *half;
      const Vec2 at = part.outline.middle();
      const FlatPiece own(part.triangle, part.outline, part.heights(at), at);
      if (least(own) < limit()) cut(part, own, cuts - 1);
    }
  }

  std::optional<MeshFeature> nearest_to(const ReliefPiece& piece, const Vec2& weights) const {
    return closest_point(ground_, pose_.to_world(piece.point(weights)), depth_ + 2 * ground_.texel());
  }

  // The local minimum of the distance to the ground that turns lead to.
  void touch(const ReliefPiece& piece) {
    const double hair = 1e-12 * ground_.texel();
    Vec2 at = piece.outline.middle();
    auto nearest = nearest_to(piece, at);
    if (!nearest) return;
    for (int turn = 0; turn < 8; ++turn) {
      const Vec3 direction = pose_.orientation.conjugate() * nearest->direction;
      const surface::PlaneCore core{direction, direction.dot(piece.point(at))};
      surface::PieceMinimiser<surface::PlaneCore> minimiser(piece, core, -hair);
      if (!minimiser.run()) break;
      // Half way, and half of that, where the ground's normal turns too soon.
      Vec2 next = minimiser.best().weights;
      bool better = false;
      for (int half = 0; half < 6 && !better; ++half) {
        const auto there = nearest_to(piece, next);
        better = there && there->distance < nearest->distance - hair;
        if (better) {
          nearest = there;
          at = next;
        }
        next = 0.5 * (next + at);
      }
      if (!better) break;
    }
    add(piece, at, *nearest);
  }

  void add(const ReliefPiece& piece, const Vec2& at, const MeshFeature& nearest) {
    if (nearest.distance < -depth_) return;
    // What has come out behind the ground is no obstacle: the outer sides must look at each other.
    const Vec3 outwards = pose_.orientation * piece.base_normal(at);
    if (outwards.dot(nearest.direction) >= 0) return;
    const int index = piece.triangle.index;
    found_.add({nearest.point, nearest.direction, nearest.distance,
                curved_feature_id(ground_, nearest.triangle, nearest.weights, Part::face, index & 255,
                                  (index >> 8) & 63)});
  }

  const Pose& pose_;
  const ReliefMesh& ground_;
  double depth_;
  Candidates& found_;
};

}  // namespace

ContactSet curved_on_curved(const ReliefMesh& body, const Pose& pose, const ReliefMesh& ground, double margin,
                            double depth) {
  ContactSet set;
  if (!is_rigid(pose)) {
    set.status = status::bad_pose;
    return set;
  }
  const double side = ground.bounds().sizes().maxCoeff();
  if (pose.position.norm() > 1e5 * side) {
    set.status |= status::far;
    return set;
  }
  if (!(margin <= side)) set.status |= status::wide_margin;
  margin = margin > 0 ? std::min(margin, side) : 0;
  depth = depth > 0 ? std::min(depth, side) : 0;
  Candidates found(margin);
  const Pose unit{pose.position, pose.orientation.normalized()};
  MeshSearch search(unit, ground, depth, found);
  body.walk(search);
  if (found.overflowed()) set.status |= status::limit;
  report(ground, found, set);
  return set;
}

}  // namespace intaglio::contact
