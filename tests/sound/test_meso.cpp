#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <functional>

#include "intaglio/vec.h"
#include "sound/rubbing.h"
#include "tests/sound/generators.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::any_number;
using test::any_vector;

namespace {

Vec3 upward_normal() {
  return Vec3(any_number(-0.9, 0.9), any_number(-0.9, 0.9), 1).normalized();
}

surface::Surface surface_of(int size, const std::function<Vec3(int, int)>& normal) {
  surface::Texels texels;
  texels.width = texels.height = size;
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) texels.normal.push_back(normal(i, j));
  }
  return {std::move(texels), surface::Placement(Vec3::Zero(), Quat::Identity(), 1, 1), 0.01,
          surface::Edge::wrap};
}

surface::Surface bumps() {
  return surface_of(64, [](int i, int j) {
    return Vec3(0.4 * std::sin(0.7 * i), 0.3 * std::cos(1.3 * j + i), 1).normalized();
  });
}

std::vector<MesoImpulse> walk(const surface::Surface& surface, const Vec2& a, const Vec2& b, double mass,
                              const Vec2& v) {
  std::vector<MesoImpulse> out(512);
  out.resize(walk_texels(surface, a, b, mass, v, out).count);
  return out;
}

}  // namespace

TEST_CASE("Eq. 1.4: p_n is zero on a flat map and grows linearly with speed and mass") {
  CHECK(rc::check([] {
    const Vec3 n_g = any_vector(1).normalized();
    RC_PRE(n_g.allFinite());
    const Mat3 frame = rotation_onto(Vec3::UnitZ(), n_g).toRotationMatrix();
    const Vec3 n_s = frame * upward_normal();
    const Vec3 v = any_vector(5);
    const Vec3 v_t = v - v.dot(n_g) * n_g;
    const double mass = any_number(0.01, 10), factor = any_number(-3, 3);
    const Vec3 p = normal_momentum(mass, v_t, n_g, n_s);
    RC_ASSERT(normal_momentum(mass, v_t, n_g, n_g).norm() < 1e-12 * mass * (1 + v_t.norm()));
    RC_ASSERT(p.cross(n_g).norm() < 1e-12 * (1 + p.norm()));
    RC_ASSERT((normal_momentum(mass, factor * v_t, n_g, n_s) - factor * p).norm() < 1e-9 * (1 + p.norm()));
    RC_ASSERT((normal_momentum(2 * mass, v_t, n_g, n_s) - 2 * p).norm() < 1e-9 * (1 + p.norm()));
    // With that momentum added the velocity lies in the plane that n_s is normal to.
    RC_ASSERT(std::abs((v_t + p / mass).dot(n_s)) < 1e-9 * (1 + v_t.norm()));
  }));
}

TEST_CASE("Eq. 1.4 stays finite where the map is vertical") {
  const Vec3 p = normal_momentum(1, Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitX());
  CHECK(p.norm() == doctest::Approx(1 / min_normal_cosine));
}

TEST_CASE("a path over a flat map gives no impulse; over any map linear in speed and mass") {
  const surface::Surface flat = surface_of(16, [](int, int) { return Vec3::UnitZ(); });
  const surface::Surface rough = bumps();
  CHECK(rc::check([&] {
    const Vec2 a(any_number(-1, 2), any_number(-1, 2)), b = a + Vec2(any_number(-1, 1), any_number(-1, 1));
    const Vec2 v(any_number(-1, 1), any_number(-1, 1));
    for (const MesoImpulse& hit : walk(flat, a, b, 1, v)) RC_ASSERT(hit.impulse == 0);
    const auto once = walk(rough, a, b, 1, v), twice = walk(rough, a, b, 2, v),
               fast = walk(rough, a, b, 1, 3 * v);
    RC_ASSERT(once.size() == twice.size());
    for (std::size_t i = 0; i < once.size(); ++i) {
      RC_ASSERT(std::abs(twice[i].impulse - 2 * once[i].impulse) < 1e-9);
      RC_ASSERT(std::abs(fast[i].impulse - 3 * once[i].impulse) < 1e-9);
    }
  }));
}

TEST_CASE("a path with more crossings than there is room for reports so") {
  std::vector<MesoImpulse> room(5);
  const MesoWalk result = walk_texels(bumps(), {0, 0}, {0.9, 0.9}, 1, Vec2::UnitX(), room);
  CHECK(result.count == 5);
  CHECK_FALSE(result.is_complete);
}

TEST_CASE(
    "a path visits every texel it crosses, in order, and its impulses add up to the change from end to end") {
  const surface::Surface rough = bumps();
  CHECK(rc::check([&] {
    const Vec2 a(any_number(0, 1), any_number(0, 1)), b(any_number(0, 1), any_number(0, 1));
    const Vec2 v(0.5, 0.2);
    const auto hits = walk(rough, a, b, 1, v);
    const auto texel = [](double x) { return int(std::floor(64 * x)); };
    RC_ASSERT(int(hits.size()) ==
              std::abs(texel(b.x()) - texel(a.x())) + std::abs(texel(b.y()) - texel(a.y())));
    double sum = 0, last = 0;
    for (const MesoImpulse& hit : hits) {
      RC_ASSERT(hit.fraction >= last && hit.fraction <= 1);
      last = hit.fraction;
      sum += hit.impulse;
    }
    const auto momentum = [&](const Vec2& uv) {
      // In the world: on a floor b is -Z.
      return normal_momentum(1, {v.x(), 0, -v.y()}, Vec3::UnitY(),
                             rough.placement().direction_to_world(rough.texel_normal(uv)))
          .y();
    };
    RC_ASSERT(std::abs(sum - momentum(b) + momentum(a)) < 1e-9);
  }));
}
