#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "haptics/proxy.h"
#include "mesh/triangle_mesh.h"
#include "tests/haptics/closed_loops.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

// 4 x 4 texels that repeat; bit k of `pattern` is texel k at the base plane, the others are 8 mm deep. 40 mm
// wide.
std::shared_ptr<const surface::Surface> two_levels(unsigned pattern) {
  return tests::made_surface(
      4,
      [pattern](Vec2 uv) {
        const int texel = 4 * int(4 * uv.y()) + int(4 * uv.x());
        return (pattern >> texel & 1u) != 0 ? 0.0 : 1.0;
      },
      [](Vec2) { return Vec3::UnitZ(); }, 0.008, tests::flat_placement(0.04));
}

// The texels whose Catmull-Rom weight is positive half way between the middle four.
constexpr unsigned highest_overshoot = 0b1001'0110'0110'1001;

}  // namespace

TEST_CASE(
    "smooth() leaves the range of its texels by at most 9/32 of it, and the felt relief ends at its top") {
  const auto worst = two_levels(highest_overshoot);
  CHECK(worst->smooth({0.5, 0.5}).height == doctest::Approx(9.0 / 32 * 0.008).epsilon(1e-12));
  Random random(12);
  double highest = -1, lowest = 1;
  for (int n = 0; n < tests::poses(3000); ++n) {
    const unsigned pattern = n == 0   ? highest_overshoot
                             : n == 1 ? ~highest_overshoot
                                      : unsigned(random.next());
    const auto s = two_levels(pattern & 0xffffu);
    const Representation representation = n % 2 == 0 ? Representation::relief : Representation::normal;
    const FeltRelief relief(s, {representation, 0.002});
    for (int k = 0; k < 20; ++k) {
      const Vec2 uv = k == 0 ? Vec2(0.5, 0.5) : Vec2(random.uniform(0, 1), random.uniform(0, 1));
      const double height = s->smooth(uv).height;
      highest = std::max(highest, height);
      lowest = std::min(lowest, height);
      CHECK_FALSE(relief.at(uv).height > relief.top() + 1e-15);
    }
  }
  CHECK(highest <= 9.0 / 32 * 0.008 * (1 + 1e-12));
  CHECK(lowest >= -(1 + 9.0 / 32) * 0.008 * (1 + 1e-12));
}

TEST_CASE("where the relief overshoots most, the tip is inside exactly when it is below the felt height") {
  const auto s = two_levels(highest_overshoot);
  const TexturedSlab slab(s, {Representation::relief, 0.002, 0.05});
  for (double uv = 0.4; uv <= 0.6; uv += 0.005) {
    const Vec3 base = s->placement().to_world({0.04 * uv, 0.04 * uv, 0});
    const double height = s->smooth({uv, uv}).height;
    for (double above = -5e-5; above <= 5e-5; above += 1e-6) {
      const Penetration p = slab.at(base + Vec3(0, height + above, 0));
      CHECK((p.depth > 1e-12) == (above < -1e-12));
    }
  }
}

TEST_CASE("a flat mesh feels like the rectangle") {
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
  const auto k = ContactSprings::for_felt_stiffness(800);
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

TEST_CASE("the sides and the underside of a slab push out, and nothing is felt beyond them") {
  const auto s = tests::brick_surface(64, 0.16);
  const TexturedSlab slab(s, {Representation::relief, 0.002, 0.05});
  const auto k = ContactSprings::for_felt_stiffness(800);
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
  proxy.reset();
  proxy.move(slab, {0, -0.06, 0}, k, 0);
  for (int n = 0; n <= 120; ++n) c = proxy.move(slab, {0, -0.06 + 0.0001 * n, 0}, k, 0);
  CHECK(c.force.y() == doctest::Approx(-800 * 0.002).epsilon(1e-6));
}

TEST_CASE("the proxy sticks within the friction cone and slips on it") {
  const auto s = tests::made_surface(
      8, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); });
  const TexturedSlab slab(s, {});
  const auto k = ContactSprings::for_felt_stiffness(800);
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
  // Back: it sticks again, and the friction reverses.
  for (double x = 0.01; x > 0; x -= slip_at / 10) c = proxy.move(slab, {x, -0.002, 0}, k, mu);
  CHECK(c.force.x() == doctest::Approx(mu * normal_force).epsilon(1e-6));
}
