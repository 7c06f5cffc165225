// Shared by all contact queries: the checks of its input, the walk over the parts of a shape, and the
// selection of the contacts that are reported. Internal to contact/; on the stack, no allocation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "contact/contact_point.h"
#include "contact/shape.h"
#include "surface/surface.h"

namespace intaglio::contact {

// A pose as rotation matrix and position, in the local frame of a placement.
struct Frame {
  Mat3 axes;
  Vec3 origin;

  Vec3 operator()(const Vec3& body) const { return origin + axes * body; }
  Vec3 back(const Vec3& local) const { return axes.transpose() * (local - origin); }
  Frame operator()(const Pose& child) const {
    return {axes * child.orientation.normalized().toRotationMatrix(), (*this)(child.position)};
  }
};
Frame local_frame(const surface::Placement& place, const Pose& pose);

// Corner k (0 to 7) of a box around the origin: bits 0, 1, 2 are the signs of x, y, z.
inline Vec3 box_corner(const Vec3& half, int k) {
  return {k & 1 ? half.x() : -half.x(), k & 2 ? half.y() : -half.y(), k & 4 ? half.z() : -half.z()};
}

// Whether the position is finite and the orientation a rotation, up to normalisation.
bool is_rigid(const Pose& pose);

// Whether the sizes of a shape are finite and above zero; a compound must have children.
bool has_size(const Shape& shape);

// Whether an offset is so many times a ground's size `side` that a double has too few digits left below it.
inline bool is_far(const Vec3& offset, double side) {
  return offset.norm() > 1e5 * side;
}

// Clamps a margin to 0..side (NaN becomes 0). Returns status::wide_margin when it was not below that limit.
unsigned limit_margin(double& margin, double side);

// Whether the rectangle in plan from `low` to `high` is more than `reach` outside of a placement's.
inline bool is_beside(const surface::Placement& place, const Vec2& low, const Vec2& high, double reach) {
  return high.x() < -reach || high.y() < -reach || low.x() > place.size_u() + reach ||
         low.y() > place.size_v() + reach;
}

// The input of a query of a shape against a rectangle, checked.
struct QuerySetup {
  const surface::Surface& surface;
  Frame frame;
  double bounding_radius = 0;
  double margin = 0;
  unsigned status = status::ok;
  bool is_clear = true;  // no contact is possible

  QuerySetup(const surface::Surface& ground, const Shape& shape, const Pose& pose, double wanted_margin);
};

// Calls visit(shape, frame, part index) for every shape that is not a compound and has a size; depth of
// nesting is bounded. Returns status bits.
template <class Visit>
unsigned for_each_part(const Shape& shape, const Frame& frame, const Visit& visit, int part = 0,
                       int nesting = 0) {
  if (!has_size(shape)) return status::no_size;
  const auto* compound = std::get_if<Compound>(&shape);
  if (compound == nullptr) {
    visit(shape, frame, part);
    return status::ok;
  }
  if (nesting >= 8) return status::limit;
  unsigned status = status::ok;
  int index = part;
  for (const CompoundChild& child : *compound->children) {
    status |= is_rigid(child.pose) ? for_each_part(child.shape, frame(child.pose), visit, index, nesting + 1)
                                   : status::bad_pose;
    ++index;
  }
  return status;
}

// Contacts whose normals differ by less count as one direction.
inline constexpr double min_angle = 20 * std::numbers::pi / 180;

// Feature of the body.
enum class BodyFeature : std::uint64_t { smooth = 0, vertex = 1, edge = 2, face = 3 };

// Feature of a relief cell: the patch inside, the crease along x or y from its first texel, or that texel.
enum class ReliefFeature : std::uint64_t { patch = 0, crease_x = 1, crease_y = 2, corner = 3 };

// The lowest `count` bits of an integer or enumerator.
template <class T>
constexpr std::uint64_t low_bits(T value, unsigned count) {
  return std::uint64_t(value) & ((std::uint64_t{1} << count) - 1);
}

// Identifies a feature of the relief and one of the body. Ids may collide above 2^18 texels a side, 2^16
// features or 2^8 parts of the body.
inline std::uint64_t feature_id(int i, int j, ReliefFeature relief, BodyFeature body, int index, int part) {
  return low_bits(i, 18) | low_bits(j, 18) << 18 | low_bits(index, 16) << 36 | low_bits(relief, 2) << 52 |
         low_bits(body, 2) << 54 | low_bits(part, 8) << 56;
}

// The grid point at or before a position in cells, and whether the position is on its column and row, give or
// take rounding: neighbouring cells then name a shared feature alike.
struct GridPlace {
  double i, j;
  bool on_column, on_row;
};
GridPlace grid_place(double x, double y);

struct Candidate {
  Vec3 point;   // on the relief
  Vec3 normal;  // unit, towards the body
  double distance;
  std::uint64_t feature;
};

// Collects candidates, keeps the deepest, and selects those to report.
//
// A pair of features that is a local minimum of the gap is a contact (`add`). When body and relief overlap
// and there is none, which happens beside walls and under narrow ridges, the caller still needs a direction
// that separates them; so searches leave two kinds of substitute on their way:
//   fallback     an overlapping pair that is nearly a local minimum. The shallowest is kept: of directions
//                that are about as good, the one that moves the body least.
//   last resort  proof of an overlap with any direction, such as a corner of the relief inside the body. The
//                deepest is kept: it is least likely to be rounding.
// `use_substitute` adds one of them, the fallback first, if no candidate overlaps.
class Candidates {
 public:
  static constexpr std::size_t capacity = 64;

  explicit Candidates(double margin) : max_distance_(margin) {}

  // Farther candidates are rejected: the margin, or once full the shallowest kept.
  double max_distance() const { return max_distance_; }
  // For searches that keep what is strictly less: also at 0, a distance of 0 is less than this.
  double search_limit() const { return max_distance_ + 1e-300; }
  std::size_t size() const { return count_; }
  const Candidate* begin() const { return kept_.data(); }
  const Candidate* end() const { return kept_.data() + count_; }
  // Whether more were added than are kept.
  bool overflowed() const { return overflowed_; }
  // Whether any that was added overlaps.
  bool overlaps() const { return overlaps_; }

  void add(const Candidate& candidate);
  void add_fallback(const Candidate& candidate) {
    if (!has_fallback_ || candidate.distance > fallback_.distance) fallback_ = candidate;
    has_fallback_ = true;
  }
  void add_last_resort(const Candidate& candidate) {
    if (!has_last_resort_ || candidate.distance < last_resort_.distance) last_resort_ = candidate;
    has_last_resort_ = true;
  }
  // Returns whether one was added.
  bool use_substitute();

  // The deepest, then those whose normals differ from all selected, then those that widen the support.
  using Selected = std::array<const Candidate*, ContactSet::capacity>;
  std::size_t select(Selected& selected);  // how many; the deepest first
  // The same as contact points in the world; sets status::limit when there were too many.
  void select(const surface::Surface& surface, ContactSet& set);

 private:
  void find_shallowest();

  std::array<Candidate, capacity> kept_;
  std::size_t count_ = 0, shallowest_ = 0;
  double max_distance_;
  bool overflowed_ = false, overlaps_ = false, has_fallback_ = false, has_last_resort_ = false;
  Candidate fallback_, last_resort_;
};

}  // namespace intaglio::contact
