// A plain Bullet world with one textured floor, as a user of Bullet would have it.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "dynamics/textured_shape.h"

namespace intaglio::tests {

struct PlainBullet {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  dynamics::TexturedShape shape;
  std::vector<std::unique_ptr<btRigidBody>> bodies;

  explicit PlainBullet(std::shared_ptr<const surface::Surface> s,
                       const dynamics::ContactOptions& options = {})
      : shape(std::move(s), options) {
    dynamics::register_algorithms(dispatcher);
    world.setGravity({0, btScalar(-9.81), 0});
  }
  ~PlainBullet() {
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }
  btRigidBody& add(btScalar mass, btCollisionShape& of, const btVector3& position) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) of.calculateLocalInertia(mass, inertia);
    bodies.push_back(
        std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(mass, nullptr, &of, inertia)));
    bodies.back()->getWorldTransform().setOrigin(position);
    world.addRigidBody(bodies.back().get());
    return *bodies.back();
  }
  void run(double seconds, int rate = 60) {
    for (int k = 0; k < seconds * rate; ++k) world.stepSimulation(btScalar(1) / btScalar(rate), 0);
  }
};

}  // namespace intaglio::tests
