// The textured rectangle as a Bullet shape, and the algorithm that lets Bullet's dispatcher meet spheres with
// it.
//
// Internal to dynamics/: includes Bullet.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "intaglio/contact/contact_point.h"
#include "intaglio/dynamics/world.h"

namespace intaglio::dynamics {

inline btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
inline Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

// Speed of approach, m/s, below which a contact does not bounce: what gravity adds in two steps, or resting
// contacts would chatter.
inline double bounce_speed(const WorldOptions& options) {
  return std::max(0.02, 2 * options.gravity.norm() * options.step);
}

class TexturedFloor : public btConcaveShape {
 public:
  TexturedFloor(std::shared_ptr<const surface::Surface> surface, const WorldOptions& options);

  // Where a sphere touches, by the chosen representation and method. Remembered until the next query for that
  // body.
  const contact::ContactSet& query(int body, const Vec3& centre, double radius, double margin);
  const contact::ContactSet& last(int body) const { return last_[static_cast<std::size_t>(body)]; }
  const surface::Surface& surface() const { return *surface_; }
  double step() const { return options_.step; }
  double bounce_speed() const { return dynamics::bounce_speed(options_); }

  void getAabb(const btTransform& t, btVector3& low, btVector3& high) const override;
  void setLocalScaling(const btVector3&) override {}
  const btVector3& getLocalScaling() const override { return scaling_; }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
  const char* getName() const override { return "TexturedFloor"; }
  void processAllTriangles(btTriangleCallback*, const btVector3&, const btVector3&) const override {}

 private:
  std::shared_ptr<const surface::Surface> surface_;
  WorldOptions options_;
  std::vector<contact::ContactSet> last_;
  btVector3 scaling_{1, 1, 1};
};

// Registers the sphere algorithm with `dispatcher`, for both orders of the pair.
void register_algorithms(btCollisionDispatcher& dispatcher);

}  // namespace intaglio::dynamics
