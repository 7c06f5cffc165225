// The answer of a contact query: where a body touches a textured surface. World frame, metres.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "intaglio/vec.h"

namespace intaglio {

struct ContactPoint {
  Vec3 point = Vec3::Zero();    // on the surface; the body's point is point + distance * normal
  Vec3 normal = Vec3::UnitY();  // unit, along which the body is pushed
  Vec3 n_s = Vec3::UnitY();     // unit, normal of the map there
  double distance = 0;          // gap; negative = penetration
  Vec2 uv = Vec2::Zero();       // on the texture, 0..1
  std::uint64_t feature = 0;    // identifies the two features that touch; constant while they do
  int triangle = -1;            // of a curved base, below the point; -1 on a rectangle or beside the relief
  Vec3 weights = Vec3::Zero();  // of the triangle's corners
};

// Bits that a query reports beside its points; several may be set.
namespace contact_status {
inline constexpr unsigned ok = 0;
inline constexpr unsigned bad_pose = 1;      // not finite, or not a rotation: nothing was computed
inline constexpr unsigned no_size = 2;       // a shape without size, or not finite, or null: left out
inline constexpr unsigned off_edge = 4;      // no part of the body is over the rectangle
inline constexpr unsigned far = 8;           // 1e5 sides away, where digits are lost: nothing was computed
inline constexpr unsigned under = 16;        // wholly under the surface: pushed up along n_g
inline constexpr unsigned wide_margin = 32;  // the margin was limited (too fast for this step): sub-step
inline constexpr unsigned limit = 64;        // more candidates than are kept: the deepest were kept
inline constexpr unsigned deep = 128;        // overlapping, but no local minimum: a substitute was used
}  // namespace contact_status

// Up to six contact points, chosen to support the body; the first is the deepest.
struct ContactSet {
  static constexpr std::size_t capacity = 6;
  std::array<ContactPoint, capacity> points;
  std::size_t count = 0;
  unsigned status = contact_status::ok;

  bool empty() const { return count == 0; }
  std::size_t size() const { return count; }
  const ContactPoint& operator[](std::size_t k) const { return points[k]; }
  const ContactPoint* begin() const { return points.data(); }
  const ContactPoint* end() const { return points.data() + count; }
};

}  // namespace intaglio
