// What contact queries answer: where a body touches a textured surface. World frame, metres.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "intaglio/vec.h"

namespace intaglio::contact {

struct ContactPoint {
  Vec3 point = Vec3::Zero();    // on the surface; the body's point is point + distance * normal
  Vec3 normal = Vec3::UnitY();  // unit, along which the body is pushed
  Vec3 n_s = Vec3::UnitY();     // unit, normal of the map there
  double distance = 0;          // gap; negative = penetration
  Vec2 uv = Vec2::Zero();
  std::uint64_t feature = 0;  // names what touches what; the same from step to step while it is the same
  int triangle = -1;          // of a curved base, below the point; -1 on a rectangle or beside the relief
  Vec3 weights = Vec3::Zero();  // of the triangle's corners
};

// What a query wants its caller to know: bits, more than one may be set.
namespace status {
inline constexpr unsigned ok = 0;
inline constexpr unsigned bad_pose = 1;  // not finite, or no rotation: nothing was asked
inline constexpr unsigned no_size = 2;   // a shape without size, or not finite, or null: left out
inline constexpr unsigned off_edge = 4;  // no part of the body is over the rectangle
inline constexpr unsigned far = 8;       // so far away (1e5 sides) that digits are lost: nothing was asked
inline constexpr unsigned under = 16;    // wholly under the surface: pushed up along n_g
inline constexpr unsigned wide_margin = 32;  // the margin was limited (too fast for this step): sub-step
inline constexpr unsigned limit = 64;        // more candidates than are kept: the deepest were kept
inline constexpr unsigned deep =
    128;  // overlapping, but no least gap tells the way out: one of the next best
}  // namespace status

// Up to six contact points, chosen to support the body; the first is the deepest.
struct ContactSet {
  static constexpr std::size_t capacity = 6;
  std::array<ContactPoint, capacity> points;
  std::size_t count = 0;
  unsigned status = status::ok;

  const ContactPoint* begin() const { return points.data(); }
  const ContactPoint* end() const { return points.data() + count; }
};

// Eq. 1.2, Sterling & Lin 2016, §1.2.3.2: the contact point of a sphere on a normal map.

// The point q (metres) at which a sphere of centre c and radius r touches the plane that the sampled unit
// normal n_s stands for. An impulse along n_s through q goes through the centre and leaves the angular
// velocity as it was.
// Eq. 1.2, Sterling & Lin 2016, §1.2.3.2
inline Vec3 sphere_contact_point(const Vec3& c, double r, const Vec3& n_s) {
  return c - r * n_s;
}

// Eq. 1.1, Sterling & Lin 2016, §1.2.3: what an impulse along a normal does to a body's velocity.

// Change of velocity (m/s) of a body of `mass` kg that a force of `force` newtons along the unit normal n
// pushes for `dt` seconds. The paper writes n_g; with a texture the sampled normal n_s takes its place.
// Eq. 1.1, Sterling & Lin 2016, §1.2.3
inline Vec3 velocity_change(double force, double dt, double mass, const Vec3& n) {
  return force * dt / mass * n;
}

}  // namespace intaglio::contact
