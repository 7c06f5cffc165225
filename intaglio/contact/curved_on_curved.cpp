#include "intaglio/contact/curved_on_curved.h"

#include <algorithm>
#include <cmath>

#include "intaglio/contact/curved_found.h"
#include "intaglio/contact/question.h"
#include "intaglio/surface/mesh/relief_closest.h"
#include "intaglio/surface/mesh/relief_minimum.h"

namespace intaglio::contact {

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
