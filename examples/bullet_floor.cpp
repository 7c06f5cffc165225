// A plain Bullet program with a textured floor: all that Intaglio adds is marked with (1) to (3).
//
//   cmake --build build/release --target example_bullet_floor && build/release/examples/example_bullet_floor
//
// Prints where the bodies are, every half second; fails when one of them went through the floor.
#include <btBulletDynamicsCommon.h>
#include <intaglio/bullet.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <vector>

int main() {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);

  // (1) Bullet learns to meet textured shapes.
  intaglio::bullet::enable(dispatcher);

  // (2) A surface: here the built-in bricks, 4 m a side and 8 cm deep.
  const auto bricks = intaglio::Surface::load("brick", {.size = {4, 4}, .depth = 0.08});
  if (!bricks) {
    std::cerr << bricks.error() << '\n';
    return 1;
  }

  // (3) Its shape, for a static body like any other.
  intaglio::bullet::SurfaceShape floor_shape(*bricks);
  btRigidBody floor(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &floor_shape));
  world.addRigidBody(&floor);

  btSphereShape ball(0.1f);
  btBoxShape box({0.15f, 0.1f, 0.2f});
  btCapsuleShape capsule(0.08f, 0.2f);
  btCylinderShape cylinder({0.12f, 0.1f, 0.12f});
  btConvexHullShape hull;
  for (const btVector3& corner : {btVector3(0.2f, 0, 0), btVector3(-0.2f, 0, 0), btVector3(0, 0.2f, 0),
                                  btVector3(0, -0.2f, 0), btVector3(0, 0, 0.2f), btVector3(0, 0, -0.2f)})
    hull.addPoint(corner);
  btCompoundShape dumb_bell;
  dumb_bell.addChildShape(btTransform(btQuaternion::getIdentity(), {-0.15f, 0, 0}), &ball);
  dumb_bell.addChildShape(btTransform(btQuaternion::getIdentity(), {0.15f, 0, 0}), &ball);

  std::vector<std::unique_ptr<btRigidBody>> bodies;
  for (btCollisionShape* shape :
       std::vector<btCollisionShape*>{&ball, &box, &capsule, &cylinder, &hull, &dumb_bell}) {
    btVector3 inertia;
    shape->calculateLocalInertia(1, inertia);
    bodies.push_back(
        std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(1, nullptr, shape, inertia)));
    const auto k = static_cast<btScalar>(bodies.size());
    bodies.back()->getWorldTransform().setOrigin({-1.4f + 0.4f * k, 0.5f, 0.1f * k});
    bodies.back()->setLinearVelocity({0, 0, 0.5f});
    world.addRigidBody(bodies.back().get());
  }

  int lost = 0;
  for (int step = 0; step <= 180; ++step) {
    world.stepSimulation(1.0f / 60, 0);
    if (step % 30 != 0) continue;
    std::printf("%4.1f s ", step / 60.0);
    for (const auto& body : bodies) {
      const btVector3& at = body->getWorldTransform().getOrigin();
      std::printf("  %-9s %6.3f m", body->getCollisionShape()->getName(), double(at.y()));
      if (step == 180 && at.y() < 0) ++lost;
    }
    std::printf("\n");
  }
  for (const auto& body : bodies) world.removeRigidBody(body.get());
  world.removeRigidBody(&floor);
  return lost;
}
