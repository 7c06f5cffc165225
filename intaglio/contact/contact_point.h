// What contact queries answer: where a body touches a textured surface. World frame, metres.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "intaglio/core/vec.h"

namespace intaglio::contact {

struct ContactPoint {
  Vec3 point = Vec3::Zero();    // on the surface
  Vec3 normal = Vec3::UnitY();  // unit, along which the body is pushed
  Vec3 n_s = Vec3::UnitY();     // unit, normal of the map there
  double distance = 0;          // gap; negative = penetration
  Vec2 uv = Vec2::Zero();
  std::uint64_t feature = 0;  // names what is touched; the same from step to step while it is the same
};

// Up to four contact points (what Bullet's manifold holds), deepest first.
struct ContactSet {
  static constexpr std::size_t capacity = 4;
  std::array<ContactPoint, capacity> points;
  std::size_t count = 0;

  const ContactPoint* begin() const { return points.data(); }
  const ContactPoint* end() const { return points.data() + count; }
};

}  // namespace intaglio::contact
