// TexturedShape in a plain Bullet program, as a user of Bullet would have it.
#include <btBulletDynamicsCommon.h>
#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "core/portable_math.h"
#include "tests/dynamics/brick_scene.h"
#include "tests/dynamics/plain_bullet.h"

using namespace intaglio;
using namespace intaglio::dynamics;
using tests::PlainBullet;
namespace scene = intaglio::tests::brick_scene;

namespace {

double height_after_fall(PlainBullet& plain, btRigidBody& body) {
  plain.run(4);
  return static_cast<double>(body.getWorldTransform().getOrigin().y());
}

}  // namespace

TEST_CASE("in a plain Bullet world, in both orders of a pair, bodies come to rest on the relief") {
  const auto s = scene::floor(128);
  btSphereShape ball(btScalar(0.1));
  btSphereShape small_ball(btScalar(0.05));
  btCompoundShape dumb_bell;
  const btTransform left(btQuaternion::getIdentity(), {btScalar(-0.08), 0, 0});
  const btTransform right(btQuaternion::getIdentity(), {btScalar(0.08), 0, 0});
  dumb_bell.addChildShape(left, &small_ball);
  dumb_bell.addChildShape(right, &small_ball);
  btCompoundShape nested;
  nested.addChildShape(btTransform::getIdentity(), &dumb_bell);
  btBoxShape box({btScalar(0.2), btScalar(0.1), btScalar(0.15)});
  btCapsuleShape capsule(btScalar(0.1), btScalar(0.3));
  btCapsuleShapeZ capsule_z(btScalar(0.1), btScalar(0.3));
  btCylinderShape cylinder({btScalar(0.1), btScalar(0.1), btScalar(0.1)});
  btCylinderShapeX cylinder_x({btScalar(0.1), btScalar(0.1), btScalar(0.1)});
  btConeShape cone(btScalar(0.15), btScalar(0.2));
  btConvexHullShape hull;
  for (int k = 0; k < 8; ++k)
    hull.addPoint(
        {btScalar(k & 1 ? 0.2 : -0.2), btScalar(k & 2 ? 0.1 : -0.1), btScalar(k & 4 ? 0.15 : -0.15)});
  for (btCollisionShape* shape : std::vector<btCollisionShape*>{
           &ball, &dumb_bell, &nested, &box, &capsule, &capsule_z, &cylinder, &cylinder_x, &cone, &hull}) {
    std::vector<double> heights;
    for (const bool floor_first : {true, false}) {
      PlainBullet plain(s);
      if (floor_first) plain.add(0, plain.shape, {0, 0, 0});
      btRigidBody& body = plain.add(1, *shape, {btScalar(0.31), btScalar(0.4), btScalar(0.17)});
      if (!floor_first) plain.add(0, plain.shape, {0, 0, 0});
      heights.push_back(height_after_fall(plain, body));
    }
    CAPTURE(shape->getName());
    for (const double height : heights) {
      CHECK(height > 0.04);
      CHECK(height < 0.3);
    }
    CHECK(heights[0] == doctest::Approx(heights[1]).epsilon(0.02));
  }
}

TEST_CASE("the surface goes where its body is: moved, turned, and as a part of a compound") {
  const auto s = scene::floor(128);
  btSphereShape ball(btScalar(0.1));
  PlainBullet here(s);
  here.add(0, here.shape, {0, 0, 0});
  const double height =
      height_after_fall(here, here.add(1, ball, {btScalar(0.3), btScalar(0.3), btScalar(0.2)}));
  PlainBullet raised(s);
  raised.add(0, raised.shape, {1, 2, 3});
  CHECK(height_after_fall(raised, raised.add(1, ball, {btScalar(1.3), btScalar(2.3), btScalar(3.2)})) - 2 ==
        doctest::Approx(height).epsilon(0.02));
  PlainBullet part(s);
  btCompoundShape stage;
  stage.addChildShape(btTransform(btQuaternion::getIdentity(), {0, 1, 0}), &part.shape);
  part.add(0, stage, {0, 1, 0});
  CHECK(height_after_fall(part, part.add(1, ball, {btScalar(0.3), btScalar(2.3), btScalar(0.2)})) - 2 ==
        doctest::Approx(height).epsilon(0.02));
}

TEST_CASE("ray casts and contact tests of Bullet see the relief") {
  const auto s = scene::floor(128);
  PlainBullet plain(s);
  btRigidBody& floor = plain.add(0, plain.shape, {0, 0, 0});
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const double x = random.uniform(-1.9, 1.9), z = random.uniform(-1.9, 1.9);
    const btVector3 from(btScalar(x), 1, btScalar(z)), to(btScalar(x), -1, btScalar(z));
    btCollisionWorld::ClosestRayResultCallback hit(from, to);
    plain.world.rayTest(from, to, hit);
    REQUIRE(hit.hasHit());
    const surface::Placement& place = s->placement();
    // Two triangles for a bilinear patch: off by a quarter of its warp.
    CHECK(static_cast<double>(hit.m_hitPointWorld.y()) ==
          doctest::Approx(-s->depth(place.uv(place.to_local({x, 0, z})))).epsilon(0.01).scale(1));
  }
  struct Deepest : btCollisionWorld::ContactResultCallback {
    double distance = 1;
    Vec3 normal;
    btScalar addSingleResult(btManifoldPoint& p, const btCollisionObjectWrapper* a, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
      if (static_cast<double>(p.getDistance()) > distance) return 0;
      distance = static_cast<double>(p.getDistance());
      const btVector3 n = a->getCollisionShape()->isConvex() ? p.m_normalWorldOnB : -p.m_normalWorldOnB;
      normal = {n.x(), n.y(), n.z()};
      return 0;
    }
  };
  btSphereShape ball(btScalar(0.1));
  btCollisionObject probe;
  probe.setCollisionShape(&ball);
  const Vec3 at = scene::above(*s, {0.4, 0.3, -0.6}, -0.01);
  probe.getWorldTransform().setIdentity();
  probe.getWorldTransform().setOrigin({btScalar(at.x()), btScalar(at.y()), btScalar(at.z())});
  for (const bool probe_first : {true, false}) {
    Deepest deepest;
    if (probe_first) {
      plain.world.contactPairTest(&probe, &floor, deepest);
    } else {
      plain.world.contactPairTest(&floor, &probe, deepest);
    }
    CHECK(deepest.distance == doctest::Approx(-0.01).epsilon(0.01));
    CHECK(deepest.normal.y() > 0);
  }
}
