// A plain Bullet program with reliefs on curved bases.
#pragma once

#include <cmath>

#include "dynamics/textured_shape.h"
#include "tests/dynamics/plain_bullet.h"
#include "tests/dynamics/worlds.h"
#include "tests/mesh/curved_bases.h"

namespace intaglio::tests {

// A plain Bullet world that corrects penetrations without adding velocity.
struct CurvedWorld : PlainBullet {
  explicit CurvedWorld(std::shared_ptr<const surface::Surface> floor = no_relief())
      : PlainBullet(std::move(floor)) {
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_splitImpulse = 1;
    info.m_splitImpulsePenetrationThreshold = 0;
    info.m_numIterations = 30;
  }
  btRigidBody& add_rolling(btScalar mass, btCollisionShape& of, const Vec3& at, double friction = 1) {
    btRigidBody& body = add(mass, of, {btScalar(at.x()), btScalar(at.y()), btScalar(at.z())});
    body.setFriction(btScalar(friction));
    body.setSleepingThresholds(0, 0);
    return body;
  }
};

inline Vec3 vec(const btVector3& v) {
  return {double(v.x()), double(v.y()), double(v.z())};
}

// J/kg.
inline double energy(const btRigidBody& body) {
  const double mass = 1 / double(body.getInvMass());
  const btVector3 spin = body.getAngularVelocity();
  return 0.5 * vec(body.getLinearVelocity()).squaredNorm() +
         0.5 * double(spin.dot(body.getInvInertiaTensorWorld().inverse() * spin)) / mass +
         g * double(body.getWorldTransform().getOrigin().y());
}

}  // namespace intaglio::tests
