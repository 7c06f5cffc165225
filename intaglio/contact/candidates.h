// Contacts found so far, and the choice of the few that are reported. Local frame of the placement, metres;
// on the stack, no allocation. Internal to contact/.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "intaglio/contact/contact_point.h"
#include "intaglio/surface/surface.h"

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

}  // namespace intaglio::contact
