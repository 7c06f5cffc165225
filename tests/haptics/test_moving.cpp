#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "haptics/servo.h"
#include "intaglio/representation.h"
#include "mesh/triangle_mesh.h"
#include "tests/haptics/closed_loops.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

// Goes where it is told, exactly.
struct Led : Device {
  Vec3 position = Vec3::Zero(), force = Vec3::Zero();
  Vec3 read() override { return position; }
  void write(const GuardedForce& f) override { force = f.newtons(); }
};

// A drag over the brick, pressed in, in the frame of the surface.
Vec3 drag(double t) {
  return {-0.03 + 0.02 * t, -0.003 + 0.002 * std::sin(5 * t), 0.01 * std::sin(2 * t)};
}

}  // namespace

TEST_CASE("a pen that goes with a moving body feels what it feels on the body at rest") {
  const auto s = tests::brick_surface(256, 0.16);
  ServoOptions options;
  options.limits.continuous_force = 7.9;
  Led at_rest, carried;
  PenServo resting(s, options), moving(s, options);
  SceneSnapshot still, scene;
  const Vec3 velocity(0.2, 0.1, -0.15), spin(0.2, 0.5, 0.1);
  double worst = 0, strongest = 0;
  for (int k = 0; k < 3000; ++k) {
    const double t = k * 1e-3;
    // The scene is 60 Hz; in between the loop carries the body on.
    const double seen = std::floor(t * 60) / 60;
    const auto at = [&](double time) { return BodyMotion{{}, velocity, spin}.after(time); };
    scene.textured = {at(seen), velocity, spin};
    scene.time = seen;
    still.time = t;
    at_rest.position = drag(t);
    carried.position = at(t).to_world(drag(t));
    resting.tick(at_rest, still, t);
    const ServoSample sample = moving.tick(carried, scene, t);
    worst = std::max(worst, (at(t).orientation.conjugate() * carried.force - at_rest.force).norm());
    strongest = std::max(strongest, at_rest.force.norm());
    if (k > 10) CHECK((sample.guard_status & guard_status::fault) == 0);
  }
  MESSAGE("largest difference " << worst << " N of " << strongest << " N");
  CHECK(strongest > 1.5);
  // Rounding, where the proxy has just slipped and not yet converged.
  CHECK(worst < 1e-3);
}

TEST_CASE("a body that rises into a resting pen pushes it, and gets the opposite impulse") {
  const auto s = tests::brick_surface(64, 0.16);
  Led device;
  device.position = {0, 0.002, 0};
  ServoOptions options;
  options.representation = Representation::flat;
  options.spring.damping = 0;
  PenServo servo(s, options);
  double given = 0;
  for (int k = 0; k < 1500; ++k) {
    SceneSnapshot scene;
    scene.time = k * 1e-3;
    scene.textured.pose.position.y() = std::min(0.004, 0.004 * scene.time);
    if (scene.time < 1) scene.textured.velocity.y() = 0.004;
    const ServoSample sample = servo.tick(device, scene, scene.time);
    given += sample.wanted.y() * 1e-3;
  }
  CHECK(device.force.y() == doctest::Approx(600 * 0.002));
  CHECK(servo.report().textured_impulse.y() == doctest::Approx(-given));
}

TEST_CASE("on a flat mesh the pen feels what it feels on the rectangle") {
  const auto s = tests::brick_surface(128, 0.16);
  auto mesh = surface::MeshPlacement::make(surface::make_quad(s->placement()));
  REQUIRE(mesh);
  const SolidOptions options{Representation::relief, 0.002, 0.1};
  const TexturedSlab slab(s, options);
  const TexturedMesh curved(s, *mesh, 0.02, options);
  Random random(4);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p(random.uniform(-0.06, 0.06), random.uniform(-0.008, 0.0), random.uniform(-0.06, 0.06));
    const Penetration a = slab.at(p), b = curved.at(p);
    CHECK(std::abs(a.depth - b.depth) < 1e-9);
    CHECK((a.gradient - b.gradient).norm() < 1e-7 * (1 + a.gradient.norm()));
  }
}

TEST_CASE("closed loops on a textured ball give no energy, and the force points out of it") {
  const double radius = 0.05;
  const auto s = tests::made_surface(
      128, [](Vec2 uv) { return 0.5 + 0.5 * std::sin(100 * uv.x()) * std::cos(60 * uv.y()); },
      [](Vec2) { return Vec3::UnitZ(); }, 0.001,
      {Vec3::Zero(), Quat::Identity(), 2 * 3.14159265 * radius, 3.14159265 * radius});
  auto mesh = surface::MeshPlacement::make(surface::make_sphere(radius, 64, 32));
  REQUIRE(mesh);
  const TexturedMesh ball(s, *mesh, 0.02, {Representation::relief, 0.002});
  const auto k = ContactStiffness::felt(800);
  Random random(2);
  double worst = -1;
  for (int n = 0; n < tests::poses(10, 400); ++n) {
    const Vec3 up = Vec3(random.normal(), 0.3 * random.normal(), random.normal()).normalized();
    const Vec3 side = up.cross(Vec3::UnitY()).normalized(), other = up.cross(side);
    std::vector<Vec3> path;
    for (int m = 0; m <= 6000; ++m) {
      const double t = m * 2 * 3.141592653589793 / 6000;
      const double r = radius + 0.0005 * std::cos(3 * t) - 0.001;
      const Vec3 direction = up + 0.05 * std::cos(t) * side + 0.05 * std::sin(2 * t) * other;
      path.push_back(r * direction.normalized());
    }
    Proxy proxy;
    double strongest = 0;
    const double work = tests::work_round(path, 0.05, [&](const Vec3& x, const Vec3&, double) {
      const auto c = proxy.move(ball, x, k, 0);
      strongest = std::max(strongest, c.force.dot(up));
      CHECK(c.force.dot(x) >= -1e-6);
      return c.force;
    });
    CHECK(strongest > 0.1);
    worst = std::max(worst, work);
  }
  MESSAGE("worst work on the hand " << 1e3 * worst << " mJ");
  CHECK(worst <= 1e-6);
}

TEST_CASE("from the side, from below, far outside: the slab's sides push out and nothing is felt beyond") {
  const auto s = tests::brick_surface(64, 0.16);
  const TexturedSlab slab(s, {Representation::relief, 0.002, 0.05});
  const auto k = ContactStiffness::felt(800);
  Proxy proxy;
  // Into the side, 3 mm.
  proxy.move(slab, {0.085, -0.02, 0}, k, 0);
  Proxy::Contact c;
  for (int n = 0; n <= 100; ++n) c = proxy.move(slab, {0.085 - 0.00008 * n, -0.02, 0}, k, 0);
  CHECK(c.force.x() == doctest::Approx(800 * 0.003).epsilon(1e-6));
  CHECK(std::abs(c.force.y()) < 1e-6);
  // Along it and off its end.
  for (int n = 0; n <= 200; ++n) c = proxy.move(slab, {0.077, -0.02, 0.0009 * n}, k, 0);
  CHECK_FALSE(c.touching);
  // From below, 2 mm.
  proxy.forget();
  proxy.move(slab, {0, -0.06, 0}, k, 0);
  for (int n = 0; n <= 120; ++n) c = proxy.move(slab, {0, -0.06 + 0.0001 * n, 0}, k, 0);
  CHECK(c.force.y() == doctest::Approx(-800 * 0.002).epsilon(1e-6));
}

TEST_CASE("friction sticks below its cone and slips on it") {
  const auto s = tests::made_surface(
      8, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); });
  const TexturedSlab slab(s, {});
  const auto k = ContactStiffness::felt(800);
  const double mu = 0.3;
  Proxy proxy;
  proxy.move(slab, {0, 0.001, 0}, k, mu);
  auto c = proxy.move(slab, {0, -0.002, 0}, k, mu);
  const double normal_force = c.force.y();
  CHECK(normal_force == doctest::Approx(1.6));
  const double slip_at = mu * normal_force / k.coupling;
  const Vec3 stuck = proxy.position();
  for (double x = 0; x < 0.99 * slip_at; x += slip_at / 50) {
    c = proxy.move(slab, {x, -0.002, 0}, k, mu);
    CHECK((proxy.position() - stuck).norm() < 1e-9);
    CHECK(c.force.x() == doctest::Approx(-k.coupling * x));
  }
  for (double x = slip_at; x < 0.01; x += slip_at / 10) {
    c = proxy.move(slab, {x, -0.002, 0}, k, mu);
    CHECK(c.force.x() == doctest::Approx(-mu * normal_force).epsilon(1e-6));
  }
  // Back: sticks again, and the friction turns round.
  for (double x = 0.01; x > 0; x -= slip_at / 10) c = proxy.move(slab, {x, -0.002, 0}, k, mu);
  CHECK(c.force.x() == doctest::Approx(mu * normal_force).epsilon(1e-6));
}
