// The paper's contact: once per picture the tip is tested against the depth map and a plane is made there;
// until the next picture the device feels that plane, whatever the texture does under the moving tip.
//
// Body frame of a slab, SI. Kept as the baseline: it has no potential, so that a closed path can give energy.
// Real-time, 0.15 us at a picture, nothing in between.
#pragma once

#include "intaglio/haptics/depth_test.h"
#include "intaglio/haptics/force.h"
#include "intaglio/haptics/plane.h"

namespace intaglio::haptics {

class HeldPlane {
 public:
  // `rate` in pictures a second; at or above the servo rate the plane is made anew every tick.
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
      see(surface, representation, x);
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
  void forget() {
    since_ = period_;
    collides_ = false;
  }

 private:
  void see(const surface::Surface& surface, Representation representation, const Vec3& x) {
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
