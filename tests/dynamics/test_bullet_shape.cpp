#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "contact/polyhedron.h"
#include "core/portable_math.h"
#include "dynamics/bullet_shape.h"
#include "tests/dynamics/brick_scene.h"
#include "tests/dynamics/plain_bullet.h"
#include "tests/sampling.h"

using namespace intaglio;
using namespace intaglio::dynamics;
namespace scene = intaglio::tests::brick_scene;

namespace {

// Corners anywhere on an ellipsoid: every one of them is a corner of the hull.
btConvexHullShape pebble(int corners, const Vec3& half) {
  btConvexHullShape out;
  Random random(7);
  for (int k = 0; k < corners; ++k) {
    const double z = random.uniform(-1, 1), angle = random.uniform(0, 6.283185307179586);
    const double across = std::sqrt(1 - z * z);
    const Vec3 p(across * std::cos(angle), across * std::sin(angle), z);
    out.addPoint(to_bullet(Vec3(half.cwiseProduct(p))), false);
  }
  out.recalcLocalAabb();
  out.setMargin(btScalar(1e-4));
  return out;
}

}  // namespace

TEST_CASE("a hull keeps its volume to 1 % however many corners it has, and lies on the relief") {
  const Vec3 half(0.12, 0.08, 0.1);
  const double ellipsoid = 4.0 / 3.0 * 3.141592653589793 * half.prod();
  for (const int corners : {100, 1000, 5000}) {
    CAPTURE(corners);
    btConvexHullShape hull = pebble(corners, half);
    const auto made = from_bullet(hull);
    REQUIRE(made);
    REQUIRE(std::holds_alternative<contact::ConvexHull>(*made));
    const double volume = contact::mass_properties(*made).volume;
    MESSAGE(corners << " corners: " << volume / ellipsoid << " of the ellipsoid");
    if (corners == 5000) CHECK(volume == doctest::Approx(ellipsoid).epsilon(0.01));
    CHECK(check_shape(hull));

    tests::PlainBullet bullet(scene::floor(64));
    bullet.add(0, bullet.shape, {0, 0, 0});
    btRigidBody& body = bullet.add(1, hull, {0, btScalar(0.15), 0});
    bullet.run(tests::is_sampled() ? 0.2 : 2);
    CHECK(double(body.getWorldTransform().getOrigin().y()) > -0.08);
    CHECK(bullet.shape.status() == 0);
  }
}

TEST_CASE("a Bullet shape that cannot touch textures is refused by name") {
  btConvexHullShape flat;
  for (int k = 0; k < 300; ++k) flat.addPoint({btScalar(std::cos(k)), 0, btScalar(std::sin(k))}, false);
  flat.recalcLocalAabb();
  const auto refused = check_shape(flat);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message().find("btConvexHullShape") != std::string::npos);
  CHECK(refused.error().message().find("one plane") != std::string::npos);

  btStaticPlaneShape plane({0, 1, 0}, 0);
  const auto endless = check_shape(plane);
  REQUIRE_FALSE(endless);
  CHECK(endless.error().message().find("STATICPLANE") != std::string::npos);

  btCompoundShape compound;
  btSphereShape ball(1);
  compound.addChildShape(btTransform::getIdentity(), &ball);
  CHECK(check_shape(compound));
  compound.addChildShape(btTransform::getIdentity(), &flat);
  CHECK_FALSE(check_shape(compound));
#ifdef NDEBUG
  tests::PlainBullet bullet(scene::floor(64));
  bullet.add(0, bullet.shape, {0, 0, 0});
  bullet.add(1, flat, {0, btScalar(0.1), 0});
  bullet.run(0.1);
  CHECK(bullet.shape.status() == contact::status::no_size);
#endif
}

TEST_CASE("a hull is built once: its next pair, and a world's own hull, take the one that exists") {
  btConvexHullShape hull = pebble(200, Vec3(0.1, 0.1, 0.1));
  const auto form = [](const Result<contact::Shape>& shape) {
    return std::get<contact::ConvexHull>(shape.value()).form;
  };
  CHECK(form(from_bullet(hull)) == form(from_bullet(hull)));
  const auto before = form(from_bullet(hull));
  hull.addPoint({btScalar(0.2), 0, 0});
  CHECK(form(from_bullet(hull)) != before);

  const contact::ConvexHull own = std::get<contact::ConvexHull>(scene::shapes()[2].shape);
  const BulletShape bullet = to_bullet(contact::Shape(own));
  CHECK(form(from_bullet(*bullet.root())) == own.form);
}
