// A plain Bullet program with reliefs on curved bases: balls in a brick bowl, and a brick ball on the floor
// beside it. All that Intaglio adds is marked with (1) to (3).
//
//   cmake --build build/release --target example_bullet_bowl && build/release/examples/example_bullet_bowl
//
// Prints where the bodies are, every half second; fails when one of them is not where it can be.
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
  world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;

  // (1) Bullet learns to meet textured shapes.
  intaglio::bullet::enable(dispatcher);

  // (2) Surfaces on meshes, the texture so many times around: a bowl of 1 m radius, its bricks 1 cm deep, and a ball of
  // 20 cm, 3 mm deep; load_mesh() reads your own meshes. And a floor.
  using namespace intaglio;
  const auto bowl = CurvedSurface::load("brick", repeated(bowl_mesh(1, 128, 64), {4, 1}), {.depth = 0.01});
  const auto ball = CurvedSurface::load("brick", repeated(sphere_mesh(0.2, 96, 48), {2, 1}), {.depth = 0.003});
  const auto ground = Surface::load("brick", {.size = {2, 2}, .depth = 0.01});
  if (!bowl || !ball || !ground) {
    std::cerr << (!bowl ? bowl.error() : !ball ? ball.error() : ground.error()) << '\n';
    return 1;
  }

  // (3) Their shapes.
  bullet::SurfaceShape bowl_shape(*bowl), brick_ball(*ball), floor_shape(*ground);

  std::vector<std::unique_ptr<btRigidBody>> bodies;
  const auto add = [&](btScalar mass, btCollisionShape& shape, const btVector3& at) -> btRigidBody& {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape.calculateLocalInertia(mass, inertia);
    bodies.push_back(std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(mass, nullptr, &shape, inertia)));
    bodies.back()->getWorldTransform().setOrigin(at);
    bodies.back()->setRollingFriction(0.002f);
    world.addRigidBody(bodies.back().get());
    return *bodies.back();
  };
  btSphereShape small(0.05f), large(0.1f);
  btCapsuleShape capsule(0.05f, 0.1f);
  add(0, bowl_shape, {0, 0, 0});
  add(0, floor_shape, {3, -1, 0});
  const std::vector<btRigidBody*> shown = {
      &add(1, small, {0.5f, -0.5f, 0}), &add(2, large, {-0.4f, -0.6f, 0.3f}),
      &add(1, capsule, {0, -0.6f, -0.4f}), &add(5, brick_ball, {2.5f, -0.7f, 0.1f})};
  shown.back()->setLinearVelocity({0.4f, 0, 0});

  for (int step = 0; step <= 480; ++step) {
    world.stepSimulation(1.0f / 120, 0);
    if (step % 60 != 0) continue;
    std::printf("%4.1f s ", step / 120.0);
    for (const btRigidBody* body : shown) {
      const btVector3& at = body->getWorldTransform().getOrigin();
      std::printf("   %6.3f %6.3f %6.3f", double(at.x()), double(at.y()), double(at.z()));
    }
    std::printf("\n");
  }
  int lost = 0;
  for (std::size_t k = 0; k + 1 < shown.size(); ++k)
    lost += shown[k]->getWorldTransform().getOrigin().length() < 1 ? 0 : 1;
  lost += shown.back()->getWorldTransform().getOrigin().y() > -0.83f ? 0 : 1;
  for (const auto& body : bodies) world.removeRigidBody(body.get());
  return lost;
}
