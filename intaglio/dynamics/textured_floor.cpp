#include "intaglio/dynamics/textured_floor.h"

#include <algorithm>

#include "intaglio/contact/relief.h"

namespace intaglio::dynamics {

TexturedFloor::TexturedFloor(std::shared_ptr<const surface::Surface> surface, const WorldOptions& options)
    : surface_(std::move(surface)), options_(options) {
  // Bullet looks algorithms up by these numbers; no built-in shape that we use shares this one.
  m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE;
}

const contact::ContactSet& TexturedFloor::query(int body, const Vec3& centre, double radius, double margin) {
  const auto slot = static_cast<std::size_t>(body);
  if (last_.size() <= slot) last_.resize(slot + 1);
  const contact::Sphere sphere{radius};
  const Pose pose{centre, Quat::Identity()};
  contact::ContactSet& set = last_[slot];
  switch (options_.representation) {
    case Representation::flat:
      set = flat_contacts(*surface_, sphere, pose, margin);
      break;
    case Representation::normal:
      set = normal_map_contacts(*surface_, sphere, pose, margin);
      break;
    case Representation::relief:
      set = options_.method == ContactMethod::closest ? relief_contacts(*surface_, sphere, pose, margin)
                                                      : directional_contacts(*surface_, sphere, pose, margin);
      break;
  }
  return set;
}

void TexturedFloor::getAabb(const btTransform&, btVector3& low, btVector3& high) const {
  const surface::Placement& place = surface_->placement();
  low.setValue(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
  high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 local((corner & 1) != 0 ? place.size_u() : 0, (corner & 2) != 0 ? place.size_v() : 0,
                     (corner & 4) != 0 ? -surface_->max_depth() : 0);
    const btVector3 world = to_bullet(place.to_world(local));
    low.setMin(world);
    high.setMax(world);
  }
  const btVector3 slack(0.01f, 0.01f, 0.01f);
  low -= slack;
  high += slack;
}

namespace {

class SphereFloorAlgorithm : public btCollisionAlgorithm {
 public:
  SphereFloorAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                       const btCollisionObjectWrapper* sphere, const btCollisionObjectWrapper* floor,
                       bool swapped)
      : btCollisionAlgorithm(info), swapped_(swapped) {
    // The sphere is body A whatever the order of the pair, so that impulses always read as "on the sphere".
    manifold_ = m_dispatcher->getNewManifold(sphere->getCollisionObject(), floor->getCollisionObject());
  }
  ~SphereFloorAlgorithm() override { m_dispatcher->releaseManifold(manifold_); }

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo&, btManifoldResult*) override {
    const btCollisionObject* ball = (swapped_ ? b : a)->getCollisionObject();
    const btCollisionObject* ground = (swapped_ ? a : b)->getCollisionObject();
    auto* floor = const_cast<TexturedFloor*>(static_cast<const TexturedFloor*>(ground->getCollisionShape()));
    const auto* sphere = static_cast<const btSphereShape*>(ball->getCollisionShape());
    const double radius = sphere->getRadius();
    const btVector3 centre = ball->getWorldTransform().getOrigin();
    // Contacts are wanted before they are passed: as far ahead as the body moves in this step.
    const Vec3 velocity = from_bullet(btRigidBody::upcast(ball)->getLinearVelocity());
    const double margin = std::max(1e-3, 2 * velocity.norm() * floor->step());
    const contact::ContactSet& contacts =
        floor->query(ball->getUserIndex(), from_bullet(centre), radius, std::min(margin, 0.5 * radius));
    // Rebuilt each step: Bullet's cached points would keep stale normals.
    manifold_->clearManifold();
    for (std::size_t k = 0; k < contacts.count; ++k) {
      const contact::ContactPoint& contact = contacts.points[k];
      // A contact that bounces must do so at full speed, not be braked softly ahead of the touch as Bullet
      // does with positive distances: it happens in whichever step ends nearest to the touch.
      const double approach = -velocity.dot(contact.normal);
      const bool bounces = approach > floor->bounce_speed();
      if (bounces && contact.distance > 0.5 * approach * floor->step()) continue;
      const double distance = bounces ? std::min(contact.distance, 0.0) : contact.distance;
      const btVector3 on_floor = to_bullet(contact.point);
      const btVector3 normal = to_bullet(contact.normal);
      const btVector3 on_ball = on_floor + normal * static_cast<btScalar>(distance);
      btManifoldPoint point(ball->getWorldTransform().invXform(on_ball),
                            ground->getWorldTransform().invXform(on_floor), normal,
                            static_cast<btScalar>(distance));
      point.m_positionWorldOnA = on_ball;
      point.m_positionWorldOnB = on_floor;
      point.m_combinedFriction = ball->getFriction() * ground->getFriction();
      point.m_combinedRestitution = ball->getRestitution() * ground->getRestitution();
      point.m_combinedRollingFriction =
          (ball->getRollingFriction() + ground->getRollingFriction()) * static_cast<btScalar>(radius);
      point.m_combinedSpinningFriction = point.m_combinedRollingFriction;
      point.m_index0 = static_cast<int>(k);
      manifold_->addManifoldPoint(point);
    }
  }

  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override { manifolds.push_back(manifold_); }

 private:
  btPersistentManifold* manifold_;
  bool swapped_;
};

struct CreateSphereFloor : btCollisionAlgorithmCreateFunc {
  explicit CreateSphereFloor(bool swapped) { m_swapped = swapped; }
  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override {
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(SphereFloorAlgorithm));
    return new (memory) SphereFloorAlgorithm(info, m_swapped ? b : a, m_swapped ? a : b, m_swapped);
  }
};

}  // namespace

void register_algorithms(btCollisionDispatcher& dispatcher) {
  static CreateSphereFloor sphere_first(false);
  static CreateSphereFloor floor_first(true);
  dispatcher.registerCollisionCreateFunc(SPHERE_SHAPE_PROXYTYPE, CUSTOM_CONCAVE_SHAPE_TYPE, &sphere_first);
  dispatcher.registerCollisionCreateFunc(CUSTOM_CONCAVE_SHAPE_TYPE, SPHERE_SHAPE_PROXYTYPE, &floor_first);
}

}  // namespace intaglio::dynamics
