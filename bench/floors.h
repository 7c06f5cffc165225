// Floors of the built-in brick, 4 m a side and 8 cm deep, as Bullet meets them: its own plane, triangle
// mesh and height field of the texels, and TexturedShape; and a world of one floor whose steps are timed.
#pragma once

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bench/brick.h"
#include "core/portable_math.h"
#include "dynamics/textured_shape.h"
#include "intaglio/representation.h"
#include "surface/closest.h"

namespace intaglio::bench {

inline constexpr double floor_side = 4, floor_depth = 0.08;  // m

using SharedSurface = std::shared_ptr<const surface::Surface>;

inline SharedSurface bricks(int size) {
  return std::make_shared<const surface::Surface>(brick(size, floor_side));
}

// A floor that can be measured, and all that it needs to live.
struct Floor {
  std::string name;
  int size = 0;  // texels a side
  double build_ms = 0, bytes = 0;
  bool is_relief = true;
  SharedSurface surface;
  std::unique_ptr<btTriangleMesh> triangles;
  std::vector<float> heights;
  std::unique_ptr<btCollisionShape> shape;
  btVector3 at{0, 0, 0};
};

// Texels are at texel centres: n + 1 of them span n texels, so the floor begins half a texel out.
inline btVector3 texel_at(const surface::Surface& s, int i, int j) {
  const Vec3 at = s.placement().to_world({(i + 0.5) * s.texel_u(), (j + 0.5) * s.texel_v(), s.texel_z(i, j)});
  return {btScalar(at.x()), btScalar(at.y()), btScalar(at.z())};
}

inline Floor plane(const SharedSurface& s) {
  Floor out{"Bullet plane", 0, 0, 0, false, s, {}, {}, {}};
  out.shape = std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0));
  return out;
}

inline Floor triangle_mesh(const SharedSurface& s) {
  Floor out{"Bullet mesh", s->width(), 0, 0, true, s, {}, {}, {}};
  const double start = cpu_seconds();
  out.triangles = std::make_unique<btTriangleMesh>();
  const int n = s->width();
  out.triangles->preallocateVertices((n + 1) * (n + 1));
  out.triangles->preallocateIndices(6 * n * n);
  for (int j = -1; j < n; ++j)
    for (int i = -1; i < n; ++i) out.triangles->findOrAddVertex(texel_at(*s, i, j), false);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      out.triangles->addTriangleIndices(a, b, c);
      out.triangles->addTriangleIndices(b, d, c);
    }
  }
  auto shape = std::make_unique<btBvhTriangleMeshShape>(out.triangles.get(), true);
  out.build_ms = 1e3 * (cpu_seconds() - start);
  out.bytes =
      16.0 * (n + 1) * (n + 1) + 24.0 * n * n + shape->getOptimizedBvh()->calculateSerializeBufferSize();
  out.shape = std::move(shape);
  return out;
}

inline Floor height_field(const SharedSurface& s) {
  Floor out{"Bullet height field", s->width(), 0, 0, true, s, {}, {}, {}};
  const double start = cpu_seconds();
  const int n = s->width() + 1;
  // Rows along +z, while v runs along -z.
  for (int row = 0; row < n; ++row)
    for (int i = -1; i < n - 1; ++i) out.heights.push_back(texel_at(*s, i, n - 2 - row).y());
  auto shape = std::make_unique<btHeightfieldTerrainShape>(
      n, n, out.heights.data(), btScalar(1), btScalar(-floor_depth), btScalar(0), 1, PHY_FLOAT, false);
  shape->setLocalScaling({btScalar(s->texel_u()), 1, btScalar(s->texel_v())});
  out.build_ms = 1e3 * (cpu_seconds() - start);
  out.bytes = 4.0 * n * n;
  out.at = (texel_at(*s, -1, -1) + texel_at(*s, n - 2, n - 2)) / 2;
  out.at.setY(btScalar(-floor_depth / 2));  // Bullet puts the middle of the heights at the origin
  out.shape = std::move(shape);
  return out;
}

inline Floor textured(const std::string& name, const SharedSurface& s,
                      const dynamics::ContactOptions& options) {
  Floor out{name, s->width(), 0, 0, options.representation == Representation::relief, s, {}, {}, {}};
  const double start = cpu_seconds();
  auto shape = std::make_unique<dynamics::TexturedShape>(s, options);
  out.build_ms = 1e3 * (cpu_seconds() - start);
  out.bytes = double(s->memory_bytes());
  if (out.is_relief) {
    // From texels to a surface that can be asked.
    const std::vector<float> depths = s->depth_texture();
    const double begin = cpu_seconds();
    const surface::Pyramid pyramid(depths, s->grid());
    out.build_ms += 1e3 * (cpu_seconds() - begin);
  }
  if (&shape->relief() != s.get()) {
    out.bytes += double(shape->relief().memory_bytes());
    // Bodies move on the relief that the normals imply: they are thrown over that, and measured in it.
    out.surface = SharedSurface(SharedSurface{}, &shape->relief());
    out.is_relief = true;
  }
  out.shape = std::move(shape);
  return out;
}

// A plain Bullet world of one floor, with Bullet's own settings. Bodies meet the floor only, and none
// sleeps.
class FloorWorld {
 public:
  static constexpr int rate = 60;  // Hz

  explicit FloorWorld(Floor& floor) {
    dynamics::register_algorithms(dispatcher_);
    world_.setGravity({0, btScalar(-9.81), 0});
    ground_ = std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(0, nullptr, floor.shape.get()));
    ground_->getWorldTransform().setOrigin(floor.at);
    ground_->setFriction(btScalar(0.707));
    world_.addRigidBody(ground_.get());
  }
  ~FloorWorld() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    world_.removeRigidBody(ground_.get());
  }
  FloorWorld(const FloorWorld&) = delete;
  FloorWorld& operator=(const FloorWorld&) = delete;

  // A body of 1 kg; the shape must outlive the world.
  void add(btConvexShape& shape) {
    btVector3 inertia;
    shape.calculateLocalInertia(1, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(1, nullptr, &shape, inertia);
    info.m_friction = btScalar(0.707);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get(), btBroadphaseProxy::DefaultFilter,
                        btBroadphaseProxy::StaticFilter);
  }
  const std::vector<std::unique_ptr<btRigidBody>>& bodies() const { return bodies_; }

  // CPU seconds of one step, solver and all.
  double timed_step() {
    const double start = cpu_seconds();
    world_.stepSimulation(btScalar(1) / rate, 0);
    return cpu_seconds() - start;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::unique_ptr<btRigidBody> ground_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

// Puts a body somewhere, unturned, with these velocities.
inline void put(btRigidBody& body, const Vec3& at, const Vec3& velocity, const Vec3& angular_velocity) {
  const auto bullet = [](const Vec3& v) {
    return btVector3(btScalar(v.x()), btScalar(v.y()), btScalar(v.z()));
  };
  body.setWorldTransform(btTransform(btQuaternion::getIdentity(), bullet(at)));
  body.setInterpolationWorldTransform(body.getWorldTransform());
  body.setLinearVelocity(bullet(velocity));
  body.setAngularVelocity(bullet(angular_velocity));
  body.clearForces();
}

// Where a body that reaches `clearance` metres around its centre starts above (x, z), a millimetre
// above the relief, or above the plane of a floor without one.
inline Vec3 start_over(const Floor& floor, double x, double z, double clearance) {
  Vec3 at(x, 0.2, z);
  for (int n = 0; n < 30; ++n) {
    const double gap = floor.is_relief
                           ? closest_point(*floor.surface, floor.surface->placement().to_local(at))->distance
                           : at.y();
    at.y() += clearance + 0.001 - gap;
  }
  return at;
}

// Balls that roll from anywhere in the middle of the floor, at 1.2 m/s in any direction, for half a
// second: adds the microseconds of each step.
inline void roll_balls(FloorWorld& world, const Floor& floor, double radius, std::uint64_t seed,
                       std::vector<double>& us) {
  Random random(seed);
  for (const auto& body : world.bodies()) {
    const double x = random.uniform(-0.3, 0.3) * floor_side;
    const double z = random.uniform(-0.3, 0.3) * floor_side;
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const Vec3 velocity(1.2 * std::cos(angle), 0, 1.2 * std::sin(angle));
    put(*body, start_over(floor, x, z, radius), velocity, Vec3::UnitY().cross(velocity) / radius);
  }
  for (int k = 0; k < FloorWorld::rate / 2; ++k) {
    const double spent = world.timed_step();
    if (k >= 3) us.push_back(1e6 * spent);  // before, pairs are made
  }
}

}  // namespace intaglio::bench
