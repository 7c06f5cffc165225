#include "bench/table_1_1/physics.h"

#include <memory>

#include "bench/floors.h"
#include "bench/relief_triangles.h"
#include "bench/table_1_1/child.h"
#include "core/portable_math.h"

namespace intaglio::bench {

namespace {

constexpr double ball_radius = 0.1;  // m
constexpr int rolling_balls = 100, thrown_of_each = 5;
constexpr int thrown_steps = 90;

// A floor with its two worlds, and the times of their steps.
struct Course {
  explicit Course(Floor made) : floor(std::move(made)), rolling(floor), thrown(floor) {}

  Floor floor;
  btSphereShape ball{btScalar(ball_radius)};
  btBoxShape box{btVector3(btScalar(0.15), btScalar(0.1), btScalar(0.2))};
  FloorWorld rolling, thrown;
  std::vector<double> rolling_us, thrown_us;
};

void fling(Course& course, int round) {
  Random random(2000 + std::uint64_t(round));
  const auto within = [&](double most) {
    const double x = random.uniform(-most, most);
    const double y = random.uniform(-most, most);
    const double z = random.uniform(-most, most);
    return Vec3(x, y, z);
  };
  for (const auto& body : course.thrown.bodies()) {
    Vec3 at = within(0.6), velocity = within(0.8);
    at.y() = random.uniform(0.4, 0.6);
    put(*body, at, velocity, within(6));
  }
  for (int k = 0; k < thrown_steps; ++k) {
    const double spent = course.thrown.timed_step();
    if (k >= 3) course.thrown_us.push_back(1e6 * spent);
  }
}

using dynamics::ContactOptions;

// The triangles of a relief, touched by our own closest features of curved bases instead of Bullet's mesh.
Floor our_mesh(const SharedSurface& s) {
  Floor out{"", s->width(), 0, 0, true, s, {}, {}, {}};
  const double start = cpu_seconds(), before = allocated_bytes();
  auto placement = surface::MeshPlacement::make(relief_triangles(*s));
  const auto flat = std::make_shared<const surface::Surface>(s->placed(s->placement(), 0));
  if (!placement) return out;
  auto relief = surface::ReliefMesh::make(flat, std::move(*placement));
  if (!relief) return out;
  out.shape = std::make_unique<dynamics::CurvedShape>(std::move(*relief));
  out.build_ms = 1e3 * (cpu_seconds() - start);
  out.bytes = allocated_bytes() - before;
  return out;
}

std::vector<std::unique_ptr<Course>> courses() {
  const SharedSurface coarse = bricks(256), fine = bricks(512);
  const auto named = [](const char* name, Floor floor) {
    floor.name = name;
    return std::make_unique<Course>(std::move(floor));
  };
  const ContactOptions implied{Representation::normal, ContactMethod::closest, NormalMethod::implied};
  const ContactOptions literal{Representation::normal, ContactMethod::closest, NormalMethod::literal};
  const ContactOptions relief{Representation::relief, ContactMethod::closest, NormalMethod::implied};
  std::vector<std::unique_ptr<Course>> out;
  out.push_back(named("normal map", textured("", fine, implied)));
  out.push_back(named("relief map", textured("", fine, relief)));
  out.push_back(named("coarse mesh", triangle_mesh(coarse)));
  out.push_back(named("fine mesh", triangle_mesh(fine)));
  out.push_back(named("normal map, literal", textured("", fine, literal)));
  out.push_back(named("fine height field", height_field(fine)));
  if (Floor mesh = our_mesh(fine); mesh.shape) out.push_back(named("fine mesh, ours", std::move(mesh)));
  return out;
}

}  // namespace

std::vector<PhysicsCost> measure_physics(int rounds) {
  const auto all = courses();
  for (const auto& course : all) {
    for (int k = 0; k < rolling_balls; ++k) course->rolling.add(course->ball);
    for (int k = 0; k < thrown_of_each; ++k) {
      course->thrown.add(course->ball);
      course->thrown.add(course->box);
    }
  }
  for (int round = 0; round < rounds; ++round) {
    for (const auto& course : all)
      roll_balls(course->rolling, course->floor, ball_radius, 1000 + std::uint64_t(round),
                 course->rolling_us);
    for (const auto& course : all) fling(*course, round);
  }
  std::vector<PhysicsCost> out;
  for (const auto& course : all) {
    out.push_back({course->floor.name, summary(course->rolling_us), summary(course->thrown_us),
                   course->floor.build_ms, course->floor.bytes});
  }
  return out;
}

}  // namespace intaglio::bench
