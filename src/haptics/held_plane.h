// The paper's haptic contact (§1.2.4, §1.3.2): a plane that the device simulates, made once per video frame.
#pragma once

#include <algorithm>

#include "intaglio/event.h"
#include "intaglio/representation.h"
#include "intaglio/vec.h"
#include "surface/surface.h"

namespace intaglio::haptics {

// The points x with normal . x = offset. SI, world frame; the normal is unit.
struct Plane {
  Vec3 normal = Vec3::UnitY();
  double offset = 0;

  // Metres; positive on the side the normal points to.
  double distance(const Vec3& x) const { return normal.dot(x) - offset; }
};

// The plane through p, the tip projected onto the surface, with the sampled unit normal n_s:
//     n_s . x - n_s . p = 0.
// Eq. 1.3, Sterling & Lin 2016, §1.2.4
inline Plane tangent_plane(const Vec3& p, const Vec3& n_s) {
  return {n_s, n_s.dot(p)};
}

// Penalty force of a plane on a tip: a damped spring that pushes and never pulls (§1.2.4).
struct Spring {
  double stiffness = 600;  // N/m
  double damping = 1.0;    // N s/m
};

// Newtons along the plane's normal; zero outside. `x` and `v` are the tip's position (m) and velocity (m/s).
inline Vec3 plane_force(const Plane& plane, const Spring& spring, const Vec3& x, const Vec3& v) {
  const double depth = -plane.distance(x);
  if (depth <= 0) return Vec3::Zero();
  return std::max(0.0, spring.stiffness * depth - spring.damping * v.dot(plane.normal)) * plane.normal;
}

// The paper's collision test of the pen's tip, against the base plane or, in relief, the depth map.
struct DepthTest {
  bool collides = false;
  Vec3 projected = Vec3::Zero();  // local; the point of the surface under the tip
};

// The tip (local frame) collides below the depth map in relief, below the base plane otherwise, and never
// beside the rectangle. Real-time, 0.05 us.
// §1.3.2, Sterling & Lin 2016
inline DepthTest depth_test(const surface::Surface& surface, Representation representation,
                            const Vec3& tip_local) {
  const surface::Placement& place = surface.placement();
  if (!tip_local.allFinite() || !place.covers(tip_local)) return {};
  const double z = representation == Representation::relief ? -surface.depth(place.uv(tip_local)) : 0.0;
  return {tip_local.z() < z, Vec3(tip_local.x(), tip_local.y(), z)};
}

// The paper's contact: once per video frame the tip is tested against the depth map and a plane is made
// there; until the next frame the hand feels that plane, whatever the texture does under the moving tip.
//
// Body frame of a slab, SI. Kept as the baseline: it has no potential, so a closed path can yield energy.
// Real-time, 0.15 us per video frame, nothing in between.
class HeldPlane {
 public:
  // `rate` in frames per second; at or above the servo rate the plane is remade every tick.
  explicit HeldPlane(double rate) : period_(1 / rate) {}

  struct Contact {
    bool touching = false;
    Vec3 force = Vec3::Zero();
    Vec3 normal = Vec3::UnitY();
    Vec3 proxy = Vec3::Zero();  // the tip's projection onto the plane while it touches
    double energy = 0;          // J, in the spring
  };

  Contact move(const surface::Surface& surface, Representation representation, const Vec3& x, const Vec3& v,
               const Spring& spring, double dt) {
    since_ += dt;
    if (since_ >= period_ * (1 - 1e-9)) {
      since_ = since_ < 2 * period_ ? since_ - period_ : 0;
      update_plane(surface, representation, x);
    }
    Contact contact{false, Vec3::Zero(), plane_.normal, x, 0};
    const double depth = -plane_.distance(x);
    if (!collides_ || depth <= 0) return contact;
    contact.touching = true;
    contact.force = plane_force(plane_, spring, x, v);
    contact.proxy = x + depth * plane_.normal;
    contact.energy = 0.5 * spring.stiffness * depth * depth;
    return contact;
  }
  void reset() {
    since_ = period_;
    collides_ = false;
  }

 private:
  void update_plane(const surface::Surface& surface, Representation representation, const Vec3& x) {
    const surface::Placement& place = surface.placement();
    const DepthTest test = depth_test(surface, representation, place.to_local(x));
    collides_ = test.collides;
    if (!collides_) return;
    const Vec3 n_s =
        representation == Representation::flat ? place.n() : surface.world_normal(place.uv(test.projected));
    plane_ = tangent_plane(place.to_world(test.projected), n_s);
  }

  double period_, since_ = 1e9;
  Plane plane_;
  bool collides_ = false;
};

}  // namespace intaglio::haptics
