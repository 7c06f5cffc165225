#include "evaluate/mesh_floor.h"

#include "evaluate/cpu_timer.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

namespace intaglio::evaluate {

namespace {

btVector3 to_bullet(const Vec3& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

Vec3 from_bullet(const btVector3& v) {
  return {double(v.x()), double(v.y()), double(v.z())};
}

}  // namespace

struct MeshFloor::Bullet {
  std::vector<btVector3> vertices;
  std::vector<int> indices;
  std::unique_ptr<btTriangleIndexVertexArray> arrays;
  std::unique_ptr<btBvhTriangleMeshShape> shape;
  std::size_t tree_bytes = 0;
};

MeshFloor::MeshFloor(const Reference& truth, const surface::Placement& placement, int cells)
    : cells_(cells), placement_(placement), bullet_(std::make_unique<Bullet>()) {
  const CpuTimer timer(build_seconds_);
  const int side = cells + 1;
  const Vec2 size = placement.size();
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const Vec2 p(size.x() * i / cells, size.y() * j / cells);
      z_.push_back(truth.height(p));
      bullet_->vertices.push_back(to_bullet(placement.to_world({p.x(), p.y(), z_.back()})));
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = j * side + i, b = a + 1, c = a + side, d = c + 1;
      for (const int k : {a, b, d, a, d, c}) bullet_->indices.push_back(k);
    }
  }
  bullet_->arrays = std::make_unique<btTriangleIndexVertexArray>(
      2 * cells * cells, bullet_->indices.data(), int(3 * sizeof(int)), side * side, &bullet_->vertices[0][0],
      int(sizeof(btVector3)));
  bullet_->shape = std::make_unique<btBvhTriangleMeshShape>(bullet_->arrays.get(), true);
  bullet_->tree_bytes = bullet_->shape->getOptimizedBvh()->calculateSerializeBufferSize();
}

MeshFloor::~MeshFloor() = default;

std::size_t MeshFloor::bytes() const {
  return bullet_->vertices.size() * sizeof(btVector3) + bullet_->indices.size() * sizeof(int) +
         bullet_->tree_bytes;
}

MeshFloor::Height MeshFloor::at(double x, double y) const {
  const Vec2 cell = placement_.size() / cells_;
  const double across = std::clamp(x / cell.x(), 0.0, double(cells_));
  const double up = std::clamp(y / cell.y(), 0.0, double(cells_));
  const int i = std::min(int(across), cells_ - 1), j = std::min(int(up), cells_ - 1);
  const double s = across - i, t = up - j;
  const double a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i, j + 1), d = vertex(i + 1, j + 1);
  // The diagonal leads from a to d.
  const Vec2 rise = s >= t ? Vec2(b - a, d - b) : Vec2(d - c, c - a);
  return {a + s * rise.x() + t * rise.y(), rise.cwiseQuotient(cell)};
}

haptics::Penetration MeshSolid::at(const Vec3& p) const {
  const surface::Placement& place = floor_->placement();
  const Vec3 local = place.to_local(p);
  if (!place.covers(local) || local.z() < -thickness_) return {};
  const MeshFloor::Height under = floor_->at(local.x(), local.y());
  return {under.z - local.z(), place.direction_to_world({under.slope.x(), under.slope.y(), -1})};
}

struct MeshWorld::State {
  std::shared_ptr<const MeshFloor> floor;
  double step;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::unique_ptr<btConvexShape> shape;
  std::unique_ptr<btRigidBody> ground, body;
};

namespace {

std::unique_ptr<btConvexShape> plain_bullet_shape(const contact::Shape& shape) {
  if (const auto* ball = std::get_if<contact::Sphere>(&shape))
    return std::make_unique<btSphereShape>(btScalar(ball->radius));
  if (const auto* box = std::get_if<contact::Box>(&shape))
    return std::make_unique<btBoxShape>(to_bullet(box->half));
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& corner : std::get<contact::ConvexHull>(shape).form->vertices)
    hull->addPoint(to_bullet(corner), false);
  hull->recalcLocalAabb();
  hull->setMargin(btScalar(1e-3 * contact::bounding_radius(shape)));  // by default 4 cm
  return hull;
}

}  // namespace

MeshWorld::MeshWorld(std::shared_ptr<const MeshFloor> floor, const Material& floor_material,
                     const contact::Shape& shape, const Material& body, double rate)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.floor = std::move(floor);
  s.step = 1 / rate;
  s.world.setGravity({0, btScalar(-9.81), 0});
  const auto set = [](btRigidBody& rigid, const Material& material) {
    rigid.setFriction(btScalar(std::sqrt(material.friction)));
    rigid.setRestitution(btScalar(material.restitution));
  };
  btBvhTriangleMeshShape* mesh = s.floor->bullet().shape.get();
  s.ground = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, mesh));
  set(*s.ground, floor_material);
  s.world.addRigidBody(s.ground.get());
  s.shape = plain_bullet_shape(shape);
  const contact::MassProperties properties = contact::mass_properties(shape);
  const double mass = body.density * properties.volume;
  s.body = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(
      btScalar(mass), nullptr, s.shape.get(), to_bullet(body.density * properties.inertia.diagonal())));
  set(*s.body, body);
  // Bullet multiplies it by the other body's friction. World does the same (dynamics/world_state.cpp).
  if (const auto* ball = std::get_if<contact::Sphere>(&shape))
    s.body->setRollingFriction(btScalar((body.rolling_resistance + floor_material.rolling_resistance) *
                                        ball->radius / std::sqrt(floor_material.friction)));
  s.body->setActivationState(DISABLE_DEACTIVATION);
  s.world.addRigidBody(s.body.get());
}

MeshWorld::~MeshWorld() {
  state_->world.removeRigidBody(state_->body.get());
  state_->world.removeRigidBody(state_->ground.get());
}

void MeshWorld::put(const BodyState& state) {
  btRigidBody& body = *state_->body;
  const Quat& q = state.pose.orientation;
  const btTransform at(btQuaternion(btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())),
                       to_bullet(state.pose.position));
  body.setCenterOfMassTransform(at);
  body.setInterpolationWorldTransform(at);
  body.setLinearVelocity(to_bullet(state.velocity));
  body.setAngularVelocity(to_bullet(state.angular_velocity));
  body.clearForces();
  state_->world.getBroadphase()->getOverlappingPairCache()->cleanProxyFromPairs(body.getBroadphaseHandle(),
                                                                                &state_->dispatcher);
}

BodyState MeshWorld::state() const {
  const btTransform& at = state_->body->getWorldTransform();
  const btQuaternion q = at.getRotation();
  return {{from_bullet(at.getOrigin()), Quat(double(q.w()), double(q.x()), double(q.y()), double(q.z()))},
          from_bullet(state_->body->getLinearVelocity()),
          from_bullet(state_->body->getAngularVelocity())};
}

void MeshWorld::step() {
  state_->world.stepSimulation(btScalar(state_->step), 0);
}

std::vector<TouchPoint> MeshWorld::touches() const {
  std::vector<TouchPoint> out;
  for (int k = 0; k < state_->dispatcher.getNumManifolds(); ++k) {
    const btPersistentManifold& manifold = *state_->dispatcher.getManifoldByIndexInternal(k);
    const bool is_body_first = manifold.getBody0() == state_->body.get();
    const double sign = is_body_first ? 1 : -1;
    for (int c = 0; c < manifold.getNumContacts(); ++c) {
      const btManifoldPoint& point = manifold.getContactPoint(c);
      if (!(double(point.m_appliedImpulse) > 0)) continue;
      const Vec3 impulse = double(point.m_appliedImpulse) * from_bullet(point.m_normalWorldOnB) +
                           double(point.m_appliedImpulseLateral1) * from_bullet(point.m_lateralFrictionDir1) +
                           double(point.m_appliedImpulseLateral2) * from_bullet(point.m_lateralFrictionDir2);
      out.push_back({from_bullet(is_body_first ? point.getPositionWorldOnB() : point.getPositionWorldOnA()),
                     sign * from_bullet(point.m_normalWorldOnB), sign * impulse});
    }
  }
  return out;
}

std::vector<Vec3> MeshWorld::normals() {
  state_->world.performDiscreteCollisionDetection();
  std::vector<std::pair<double, Vec3>> found;
  for (int k = 0; k < state_->dispatcher.getNumManifolds(); ++k) {
    const btPersistentManifold& manifold = *state_->dispatcher.getManifoldByIndexInternal(k);
    const double sign = manifold.getBody0() == state_->body.get() ? 1 : -1;
    for (int c = 0; c < manifold.getNumContacts(); ++c) {
      const btManifoldPoint& point = manifold.getContactPoint(c);
      found.push_back({double(point.getDistance()), sign * from_bullet(point.m_normalWorldOnB)});
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vec3> normals;
  for (const auto& [distance, normal] : found) normals.push_back(normal);
  return normals;
}

}  // namespace intaglio::evaluate
