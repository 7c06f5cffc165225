// Contacts found so far, and the choice of the few that are reported. Local frame of the placement, metres;
// on the stack, no allocation. Internal to contact/.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "contact/contact_point.h"
#include "contact/shape.h"
#include "surface/surface.h"

namespace intaglio::contact {

// Of two contacts whose normals differ by less, one may stand for the other.
inline constexpr double min_angle = 20 * std::numbers::pi / 180;

// What of the body touches.
enum class Part : std::uint64_t { round = 0, vertex = 1, edge = 2, face = 3 };

// What of a cell: its inside, the crease along x or along y from its first texel, that texel.
enum class Where : std::uint64_t { patch = 0, crease_x = 1, crease_y = 2, corner = 3 };

// A name for what touches what: a place on the relief and a part of the body. Different ones may share a name
// above 2^18 texels, 2^16 parts or 2^8 children.
inline std::uint64_t feature_id(int i, int j, Where where, Part part, int index, int child) {
  const auto bits = [](auto value, unsigned count) {
    return static_cast<std::uint64_t>(value) & ((std::uint64_t{1} << count) - 1);
  };
  return bits(i, 18) | bits(j, 18) << 18 | bits(index, 16) << 36 | bits(where, 2) << 52 |
         bits(part, 2) << 54 | bits(child, 8) << 56;
}

struct Candidate {
  Vec3 point;   // on the relief
  Vec3 normal;  // unit, towards the body
  double distance;
  std::uint64_t feature;
};

// The deepest that were added, as many as are kept.
class Candidates {
 public:
  static constexpr std::size_t capacity = 64;

  explicit Candidates(double margin) : limit_(margin) {}

  // Farther ones are not wanted: the margin, or once full the shallowest kept.
  double limit() const { return limit_; }
  std::size_t size() const { return count_; }
  const Candidate& operator[](std::size_t k) const { return kept_[k]; }
  const Candidate* begin() const { return kept_.data(); }
  const Candidate* end() const { return kept_.data() + count_; }
  bool overflowed() const { return overflowed_; }
  // Whether any that was added overlaps.
  bool overlaps() const { return overlaps_; }

  void add(const Candidate& candidate);

  // A way out of an overlap that is no least gap, for when nothing better is found. The shortest is kept.
  void add_spare(const Candidate& candidate) {
    if (!has_spare_ || candidate.distance > spare_.distance) spare_ = candidate;
    has_spare_ = true;
  }
  // Something that shows an overlap, and some way out of it; for when there is not even a spare. The deepest
  // is kept.
  void add_witness(const Candidate& candidate) {
    if (!has_witness_ || candidate.distance < witness_.distance) witness_ = candidate;
    has_witness_ = true;
  }
  // Adds the spare, or else the witness, if nothing overlaps so far; whether it did.
  bool use_spare();

  // The deepest, then those whose normals differ from all chosen, then those that widen the support.
  using Chosen = std::array<const Candidate*, ContactSet::capacity>;
  std::size_t choose(Chosen& chosen);  // how many; the deepest first
  void choose(const surface::Surface& surface, ContactSet& set);

 private:
  void find_shallowest();

  std::array<Candidate, capacity> kept_;
  std::size_t count_ = 0, shallowest_ = 0;
  double limit_;
  bool overflowed_ = false, overlaps_ = false, has_spare_ = false, has_witness_ = false;
  Candidate spare_, witness_;
};

// What every query begins with: the body's pose in the placement's frame, the margin within bounds, and what
// is wrong with the question. Internal to contact/.

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

struct Question {
  const surface::Surface& surface;
  Frame frame;
  double reach;    // bounding radius of the body
  double margin;   // within bounds
  unsigned wrong;  // status bits
  bool hopeless;   // there is nothing to look for

  Question(const surface::Surface& asked, const Shape& shape, const Pose& pose, double wanted_margin);
};

// Whether the position is finite and the orientation a rotation, give or take its length.
bool is_rigid(const Pose& pose);

// Whether the sizes of a shape are finite and above zero; of a compound, whether those of some child are.
bool has_size(const Shape& shape);

// Calls visit(shape, frame, child index) for every shape that is not a compound and has a size; depth of
// nesting is bounded. Returns status bits.
template <class Visit>
unsigned for_each_part(const Shape& shape, const Frame& frame, const Visit& visit, int child = 0,
                       int nesting = 0);

template <class Visit>
unsigned for_each_part(const Shape& shape, const Frame& frame, const Visit& visit, int child, int nesting) {
  if (!has_size(shape)) return status::no_size;
  const auto* compound = std::get_if<Compound>(&shape);
  if (compound == nullptr) {
    visit(shape, frame, child);
    return status::ok;
  }
  if (nesting >= 8) return status::limit;
  unsigned wrong = status::ok;
  int index = child;
  for (const CompoundChild& part : *compound->children) {
    wrong |= is_rigid(part.pose) ? for_each_part(part.shape, frame(part.pose), visit, index, nesting + 1)
                                 : status::bad_pose;
    ++index;
  }
  return wrong;
}

}  // namespace intaglio::contact
