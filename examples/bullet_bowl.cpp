// A plain Bullet program with reliefs on curved bases: balls in a brick bowl, and a brick ball on the floor
// beside it. All that Intaglio adds is marked with (1) to (3).
//
//   cmake --build build/release --target example_bullet_bowl && build/release/examples/example_bullet_bowl
//
// Prints where the bodies are, every half second; fails when one of them is not where it can be.
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <memory>
#include <vector>

#include "dynamics/textured_shape.h"
#include "mesh/triangle_mesh.h"
#include "surface/import.h"

using namespace intaglio::surface;

namespace {

// (1) A surface on a mesh: here a built-in one, the texture `times` around; read_mesh() reads yours.
intaglio::Result<ReliefMesh> bricks_on(TriangleMesh mesh, std::shared_ptr<const Surface> bricks,
                                       double times) {
  for (intaglio::Vec2& uv : mesh.uvs) uv.x() *= times;
  auto base = MeshPlacement::make(std::move(mesh));
  if (!base) return tl::unexpected(base.error());
  return ReliefMesh::make(std::move(bricks), std::move(*base));
}

std::shared_ptr<const Surface> bricks(double side, double depth) {
  const Placement placement({0, 0, 0}, intaglio::Quat::Identity(), side, side);
  return std::make_shared<const Surface>(to_texels(make_brick({})), placement, depth, Edge::wrap);
}

}  // namespace

int main() {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;

  // (2) Bullet learns to meet textured shapes.
  intaglio::dynamics::register_algorithms(dispatcher);

  // (3) Their shapes: a bowl of 1 m radius, its bricks 1 cm deep; a ball of 20 cm, 3 mm deep; a floor.
  const auto bowl_relief = bricks_on(make_bowl(1, 128, 64), bricks(1, 0.01), 4);
  const auto ball_relief = bricks_on(make_sphere(0.2, 96, 48), bricks(1, 0.003), 2);
  if (!bowl_relief || !ball_relief) {
    fmt::print("{}\n", (bowl_relief ? ball_relief : bowl_relief).error().message());
    return 1;
  }
  intaglio::dynamics::CurvedShape bowl_shape(*bowl_relief), brick_ball(*ball_relief);
  intaglio::dynamics::TexturedShape floor_shape(bricks(2, 0.01));

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
    fmt::print("{:4.1f} s ", step / 120.0);
    for (const btRigidBody* body : shown) {
      const btVector3& at = body->getWorldTransform().getOrigin();
      fmt::print("   {:6.3f} {:6.3f} {:6.3f}", at.x(), at.y(), at.z());
    }
    fmt::print("\n");
  }
  int lost = 0;
  for (std::size_t k = 0; k + 1 < shown.size(); ++k)
    lost += shown[k]->getWorldTransform().getOrigin().length() < 1 ? 0 : 1;
  lost += shown.back()->getWorldTransform().getOrigin().y() > -0.83f ? 0 : 1;
  for (const auto& body : bodies) world.removeRigidBody(body.get());
  return lost;
}
