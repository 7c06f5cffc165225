// Cost of reliefs on curved bases: bench_curved [--json]. Thread-CPU time, microseconds, median and p99.
//
//   query  one contact query of a body that touches a brick ball of 1 m across, the texture twice around
//          (2 cm deep): a sphere of 5 cm radius, a capsule, a box; margin 1 mm. By triangles of the base and
//          texels a side.
//   step   a whole step of a plain Bullet world at 240 Hz, solver and all: a ball that rolls in a brick bowl;
//          a box with bricks above and below that settles in one; a brick ball on a smooth and a brick floor.
//   build  the relief mesh from a placed mesh, ms.
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "bench/brick.h"
#include "contact/curved_contacts.h"
#include "core/portable_math.h"
#include "dynamics/textured_shape.h"
#include "dynamics/world.h"
#include "mesh/relief_closest.h"
#include "mesh/triangle_mesh.h"

using namespace intaglio;
using bench::cpu_seconds;

namespace {

struct Row {
  std::string what;
  int triangles, texels;
  double median, p99;
  std::string unit;
};

using SharedSurface = std::shared_ptr<const surface::Surface>;

SharedSurface bricks(int size, double side) {
  return std::make_shared<const surface::Surface>(bench::brick(size, side));
}

surface::ReliefMesh relief_on(surface::TriangleMesh mesh, SharedSurface s, double times_u) {
  for (Vec2& uv : mesh.uvs) uv.x() *= times_u;
  return *surface::ReliefMesh::make(std::move(s), *surface::MeshPlacement::make(std::move(mesh)));
}

Row timed(std::string what, const surface::ReliefMesh& relief, int count,
          const std::function<void(int)>& run) {
  std::vector<double> us;
  for (int k = 0; k < count; ++k) {
    const double start = cpu_seconds();
    run(k);
    us.push_back((cpu_seconds() - start) * 1e6);
  }
  std::sort(us.begin(), us.end());
  const auto at = [&](double share) { return us[std::size_t(share * (count - 1))]; };
  return {std::move(what),
          int(relief.base().mesh().triangles.size()),
          relief.surface().width(),
          at(0.5),
          at(0.99),
          "us"};
}

volatile double sink;

// Where a ball of 5 cm about touches: 1 mm in to 1 mm apart.
std::vector<Pose> touching(const surface::ReliefMesh& relief, int count) {
  Random random(1);
  std::vector<Pose> out;
  while (int(out.size()) < count) {
    const Vec3 way = Vec3(random.normal(), 0.4 * random.normal(), random.normal()).normalized();
    Vec3 at = 0.56 * way;
    for (int k = 0; k < 10; ++k) at += (0.05 - surface::closest_point(relief, at, 1)->distance) * way;
    const Quat turn = Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    out.push_back({at + random.uniform(-0.001, 0.001) * way, turn});
  }
  return out;
}

void measure_queries(int around, int size, std::vector<Row>& rows) {
  const auto s = bricks(size, 1);
  const auto relief = relief_on(surface::make_sphere(0.5, around, around / 2), s, 2);
  const auto placed = *surface::MeshPlacement::make(surface::make_sphere(0.5, around, around / 2));
  const double start = cpu_seconds();
  const auto again = surface::ReliefMesh::make(s, placed);
  const double build = (cpu_seconds() - start) * 1e3;
  const auto poses = touching(relief, 300);
  const auto ask = [&](const std::string& what, const contact::Shape& body) {
    rows.push_back(timed("query, " + what, relief, 3000, [&](int k) {
      const Pose& pose = poses[std::size_t(k) % poses.size()];
      sink = sink + double(contact::curved_contacts(relief, body, pose, 0.001).count);
    }));
  };
  ask("sphere", contact::Sphere{0.05});
  ask("capsule", contact::Capsule{0.03, 0.02});
  ask("box", contact::Box{Vec3(0.04, 0.03, 0.03)});
  rows.push_back({"build", rows.back().triangles, size, build, build, "ms"});
}

struct World {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btRigidBody>> bodies;

  World() { dynamics::register_algorithms(dispatcher); }
  ~World() {
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }
  btRigidBody& add(btScalar mass, btCollisionShape& shape, const btVector3& at) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape.calculateLocalInertia(mass, inertia);
    bodies.push_back(std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(mass, nullptr, &shape, inertia)));
    bodies.back()->getWorldTransform().setOrigin(at);
    bodies.back()->setSleepingThresholds(0, 0);
    world.addRigidBody(bodies.back().get());
    return *bodies.back();
  }
};

void measure_bowl(int around, int size, std::vector<Row>& rows) {
  dynamics::CurvedShape bowl(relief_on(surface::make_bowl(1, around, around / 2), bricks(size, 1), 4));
  btSphereShape ball(0.1f);
  World w;
  w.add(0, bowl, {0, 0, 0});
  btRigidBody& body = w.add(1, ball, {0.5f, -0.6f, 0});
  rows.push_back(timed("step, ball in a brick bowl", bowl.relief(), 2000, [&](int k) {
    if (k % 200 == 0) {  // thrown anew
      body.getWorldTransform().setOrigin({0.5f, -0.6f, 0});
      body.setLinearVelocity({0, 0, 1});
    }
    w.world.stepSimulation(1.0f / 240, 0);
  }));
}

// A box of 20 cm with bricks above and below, as dynamics::World makes it, that settles in a brick bowl.
void measure_box(int around, int size, std::vector<Row>& rows) {
  const auto bowl = relief_on(surface::make_bowl(0.5, around, around / 2), bricks(size, 1), 2);
  std::unique_ptr<dynamics::World> world;
  rows.push_back(timed("step, box with two reliefs in a bowl", bowl, 480, [&](int k) {
    if (k % 120 == 0) {  // thrown anew
      dynamics::WorldOptions options;
      options.step = 1.0 / 240;
      world = std::make_unique<dynamics::World>(bowl, *find_material("stone"), options);
      dynamics::ShapeBody box;
      box.shape = contact::Box{{0.08, 0.05, 0.08}};
      box.material = *find_material("wood");
      const Quat upside_down(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()));
      for (const surface::Placement& place : {surface::Placement({0, -0.05, 0}, upside_down, 0.16, 0.16),
                                              surface::Placement({0, 0.05, 0}, Quat::Identity(), 0.16, 0.16)})
        box.faces.push_back(std::make_shared<const surface::Surface>(bench::upsampled(*bricks(128, 1), 128),
                                                                     place, 0.004, surface::Edge::clamp));
      box.pose.position = {-0.1, -0.38, 0.05};
      box.velocity = {0.3, 0, 0.2};
      world->add(box);
    }
    world->step();
  }));
}

void measure_ball(int around, int size, bool smooth, std::vector<Row>& rows) {
  // A ball of 20 cm across, its own bricks 4 mm deep at 256 texels.
  dynamics::CurvedShape ball(relief_on(surface::make_sphere(0.1, around, around / 2), bricks(256, 0.2), 2));
  surface::Texels none;
  none.width = none.height = 1;
  none.depth = {0};
  none.normal = {Vec3::UnitZ()};
  none.colour = Image8(1, 1, 3);
  const surface::Placement placement(Vec3::Zero(), Quat::Identity(), 4, 4);
  const auto plane =
      std::make_shared<const surface::Surface>(std::move(none), placement, 0, surface::Edge::wrap);
  dynamics::TexturedShape floor(smooth ? plane : bricks(size, 1));
  World w;
  w.add(0, floor, {0, 0, 0});
  btRigidBody& body = w.add(1, ball, {-0.3f, 0.1f, 0});
  rows.push_back(timed(smooth ? "step, brick ball on a smooth floor" : "step, brick ball on a brick floor",
                       ball.relief(), 1000, [&](int k) {
                         if (k % 100 == 0) {
                           body.getWorldTransform().setOrigin({-0.3f, 0.1f, 0});
                           body.setLinearVelocity({1, 0, 0});
                           body.setAngularVelocity({0, 0, -10});
                         }
                         w.world.stepSimulation(1.0f / 240, 0);
                       }));
  rows.back().texels = smooth ? 1 : size;
}

}  // namespace

int main(int argc, char** argv) {
  const bool json = argc == 2 && std::strcmp(argv[1], "--json") == 0;
  if (argc > 1 && !json) {
    fmt::print(stderr, "bench_curved: '{}' is not --json\n", argv[1]);
    return 2;
  }
  std::vector<Row> rows;
  for (const auto& [around, size] :
       {std::pair{16, 512}, std::pair{64, 512}, std::pair{256, 512}, std::pair{64, 128}, std::pair{64, 2048}})
    measure_queries(around, size, rows);
  for (const auto& [around, size] : {std::pair{64, 512}, std::pair{256, 512}, std::pair{64, 2048}})
    measure_bowl(around, size, rows);
  for (const auto& [around, size] : {std::pair{64, 256}, std::pair{128, 512}})
    measure_box(around, size, rows);
  measure_ball(64, 0, true, rows);
  measure_ball(256, 0, true, rows);
  for (const auto& [around, size] : {std::pair{64, 256}, std::pair{256, 256}, std::pair{64, 1024}})
    measure_ball(around, size, false, rows);
  if (json) fmt::print("[\n");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& r = rows[k];
    if (json) {
      fmt::print(
          "  {{\"what\": \"{}\", \"triangles\": {}, \"texels\": {}, \"median\": {:.4g}, \"p99\": {:.4g}, "
          "\"unit\": \"{}\"}}{}\n",
          r.what, r.triangles, r.texels, r.median, r.p99, r.unit, k + 1 < rows.size() ? "," : "");
    } else {
      fmt::print("{:<36}{:>8} triangles{:>6}^2{:>10.1f}{:>10.1f} {}\n", r.what, r.triangles, r.texels,
                 r.median, r.p99, r.unit);
    }
  }
  if (json) fmt::print("]\n");
  return 0;
}
