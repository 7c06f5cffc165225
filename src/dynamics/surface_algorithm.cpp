// How Bullet's dispatcher meets a body with a TexturedShape.
#include <algorithm>
#include <array>
#include <cmath>

#include "dynamics/approach.h"
#include "dynamics/bullet_shape.h"
#include "dynamics/textured_shape.h"
#include "intaglio/bullet.h"

namespace intaglio::dynamics {

namespace {

// What the pair's contacts share: Bullet's rules of combination.
btManifoldPoint combined(const btCollisionObject& body, const btCollisionObject& textured) {
  btManifoldPoint out{btVector3(0, 0, 0), btVector3(0, 0, 0), btVector3(0, 1, 0), 0};
  out.m_combinedFriction = btManifoldResult::calculateCombinedFriction(&body, &textured);
  out.m_combinedRestitution = btManifoldResult::calculateCombinedRestitution(&body, &textured);
  out.m_combinedRollingFriction = btManifoldResult::calculateCombinedRollingFriction(&body, &textured);
  out.m_combinedSpinningFriction = btManifoldResult::calculateCombinedSpinningFriction(&body, &textured);
  return out;
}

// A feature's name is kept in the point's two numbers that belong to the textured body.
void set_feature(btManifoldPoint& point, std::uint64_t feature) {
  point.m_partId1 = static_cast<int>(static_cast<std::uint32_t>(feature >> 32));
  point.m_index1 = static_cast<int>(static_cast<std::uint32_t>(feature));
}
bool has_feature(const btManifoldPoint& point, std::uint64_t feature) {
  return static_cast<std::uint32_t>(point.m_partId1) == static_cast<std::uint32_t>(feature >> 32) &&
         static_cast<std::uint32_t>(point.m_index1) == static_cast<std::uint32_t>(feature);
}

// The shape that a user's SurfaceShape stands for, or one of the world's own.
const TouchableShape& touchable(const btCollisionShape& shape) {
  const auto* users = dynamic_cast<const bullet::SurfaceShape*>(&shape);
  return users != nullptr ? users->impl() : static_cast<const TouchableShape&>(shape);
}

// m/s^2, on what bounces.
double gravity_of(const btCollisionObject& object) {
  const btRigidBody* body = btRigidBody::upcast(&object);
  return body == nullptr ? 0 : static_cast<double>(body->getGravity().length());
}

class SurfaceAlgorithm : public btCollisionAlgorithm {
 public:
  SurfaceAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper& body,
                   const btCollisionObjectWrapper& textured, bool swapped, bool reports)
      : btCollisionAlgorithm(info),
        shape_(from_bullet(*body.getCollisionShape())),
        swapped_(swapped),
        reports_(reports) {
    if (body.getCollisionShape()->getShapeType() == CUSTOM_CONCAVE_SHAPE_TYPE)
      relief_ = &touchable(*body.getCollisionShape());
    add_manifold(*body.getCollisionObject(), *textured.getCollisionObject());
  }
  ~SurfaceAlgorithm() override {
    for (std::size_t k = 0; k < manifold_count_; ++k) m_dispatcher->releaseManifold(manifolds_[k]);
  }

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override {
    const btCollisionObjectWrapper& body = swapped_ ? *b : *a;
    const btCollisionObjectWrapper& textured = swapped_ ? *a : *b;
    const TouchableShape& shape = touchable(*textured.getCollisionShape());
    if (reports_) return report(shape, body, textured, *result);
    const Approach approach(body, textured, static_cast<double>(info.m_timeStep));
    const double slack = 0.01 * std::min(shape.texel(), approach.reach);
    Ahead contacts;
    if (is_near(shape, approach)) contacts = contacts_of(shape, approach, slack);
    if (relief_ != nullptr || (is_free(body) && is_free(textured))) leave_alone(contacts, slack);
    fill(contacts, approach, slack, *body.getCollisionObject(), *textured.getCollisionObject(),
         textured.getWorldTransform());
  }

  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }
  void getAllContactManifolds(btManifoldArray& manifolds) override {
    for (std::size_t k = 0; k < manifold_count_; ++k) manifolds.push_back(manifolds_[k]);
  }

 private:
  static constexpr std::size_t per_manifold = MANIFOLD_CACHE_SIZE;
  static constexpr std::size_t most_manifolds =
      (contact::ContactSet::capacity + per_manifold - 1) / per_manifold;
  // Those of the step before.
  struct OldPoints {
    std::array<btManifoldPoint, most_manifolds * per_manifold> points;
    std::size_t count = 0;

    const btManifoldPoint* find(std::uint64_t feature) const {
      for (std::size_t k = 0; k < count; ++k)
        if (has_feature(points[k], feature)) return &points[k];
      return nullptr;
    }
  };

  // The body is A whatever the order of the pair, so that impulses always read as "on the body".
  void add_manifold(const btCollisionObject& body, const btCollisionObject& textured) {
    manifolds_[manifold_count_++] = m_dispatcher->getNewManifold(&body, &textured);
  }

  static bool is_near(const TouchableShape& shape, const Approach& approach) {
    const double far = approach.reach + std::min(approach.travel(), shape.look_ahead()) + 1e-3;
    const Vec3 away = Vec3::Constant(far);
    return shape.is_near(to_bullet(Vec3(approach.pose.position - away)),
                         to_bullet(Vec3(approach.pose.position + away)));
  }

  static bool is_free(const btCollisionObjectWrapper& one) {
    return !one.getCollisionObject()->isStaticOrKinematicObject();
  }

  // Two reliefs that fit touch everywhere, and which points are told changes; and what undoing an overlap
  // lifts falls back. Overlaps that nobody sees are not undone, or a pile trembles for ever.
  void leave_alone(contact::ContactSet& contacts, double overlap) const {
    if (relief_ != nullptr) overlap = std::min(overlap, 0.01 * relief_->texel());
    for (std::size_t k = 0; k < contacts.count; ++k)
      if (double& d = contacts.points[k].distance; d < 0) d = std::min(d + overlap, 0.0);
  }

  Ahead contacts_of(const TouchableShape& shape, const Approach& approach, double slack) const {
    if (relief_ == nullptr) return contacts_ahead(shape, shape_, approach, slack);
    return touch_of_reliefs(*relief_, approach.pose, shape,
                            std::min(approach.travel() + slack, shape.texel()));
  }

  // For contactTest and its kin, who collect the points themselves. B is who is second in the manifold.
  void report(const TouchableShape& shape, const btCollisionObjectWrapper& body,
              const btCollisionObjectWrapper& textured, btManifoldResult& result) const {
    result.setPersistentManifold(manifolds_[0]);
    const btTransform& frame = textured.getWorldTransform();
    const Pose pose = from_bullet(frame.inverseTimes(body.getWorldTransform()));
    const auto margin = static_cast<double>(result.m_closestPointDistanceThreshold);
    const contact::ContactSet found = relief_ != nullptr ? touch_of_reliefs(*relief_, pose, shape, margin)
                                                         : shape.contacts(shape_, pose, margin);
    for (const contact::ContactPoint& c : found) {
      const btVector3 normal = frame.getBasis() * to_bullet(c.normal);
      const btVector3 on_surface = frame(to_bullet(c.point));
      const auto distance = static_cast<btScalar>(c.distance);
      result.addContactPoint(normal, on_surface, distance);
    }
  }

  // Rebuilt each step, or Bullet's cached points would keep stale normals; impulses stay with their feature.
  void fill(const Ahead& contacts, const Approach& approach, double slack, const btCollisionObject& body,
            const btCollisionObject& textured, const btTransform& frame) {
    const OldPoints old = old_points();
    btManifoldPoint point = combined(body, textured);
    const Meetings met = meetings(contacts, approach, static_cast<double>(point.m_combinedRestitution),
                                  least_bounce(gravity_of(body), approach.dt), slack);
    std::size_t count = 0;
    for (std::size_t k = 0; k < contacts.count; ++k) {
      const contact::ContactPoint& c = contacts.points[k];
      const btManifoldPoint* before = old.find(c.feature);
      // What was not there a step ago cannot be deeper than the body has come since.
      const bool is_new = before == nullptr && old.count > 0 && contacts.count > 1;
      if (is_new && met[k].distance < -(approach.travel() + 0.02 * approach.reach)) continue;
      if (met[k].waits) continue;
      point.m_combinedRestitution = static_cast<btScalar>(met[k].restitution);
      point.m_normalWorldOnB = frame.getBasis() * to_bullet(c.normal);
      point.m_positionWorldOnB = frame(to_bullet(c.point));
      point.m_distance1 = static_cast<btScalar>(met[k].distance);
      point.m_positionWorldOnA = point.m_positionWorldOnB + point.m_normalWorldOnB * point.m_distance1;
      point.m_localPointA = body.getWorldTransform().invXform(point.m_positionWorldOnA);
      point.m_localPointB = textured.getWorldTransform().invXform(point.m_positionWorldOnB);
      set_feature(point, c.feature);
      point.m_appliedImpulse = before ? before->m_appliedImpulse : 0;
      point.m_lifeTime = before ? before->m_lifeTime + 1 : 0;
      const bool was_pressed = before && before->m_appliedImpulse > 0;
      set_touch(point, was_pressed && c.distance <= slack ? std::nullopt : met[k].touch);
      place(point, count++, body, textured);
    }
    for (std::size_t m = 0; m < manifold_count_; ++m)
      manifolds_[m]->setNumContacts(
          static_cast<int>(std::min(count - std::min(count, m * per_manifold), per_manifold)));
    tell(old.count, count);
  }

  OldPoints old_points() const {
    OldPoints old;
    for (std::size_t m = 0; m < manifold_count_; ++m) {
      for (int k = 0; k < manifolds_[m]->getNumContacts(); ++k)
        old.points[old.count++] = manifolds_[m]->getContactPoint(k);
    }
    return old;
  }

  // As the `k`-th of the pair.
  void place(const btManifoldPoint& point, std::size_t k, const btCollisionObject& body,
             const btCollisionObject& textured) {
    const std::size_t m = k / per_manifold, at = k % per_manifold;
    if (m == manifold_count_) add_manifold(body, textured);
    manifolds_[m]->setNumContacts(static_cast<int>(at) + 1);
    manifolds_[m]->getContactPoint(static_cast<int>(at)) = point;
  }

  // Bullet's listeners, as its own algorithms tell them.
  void tell(std::size_t before, std::size_t after) const {
    if (before == 0 && after > 0 && gContactStartedCallback != nullptr)
      gContactStartedCallback(manifolds_[0]);
    if (before > 0 && after == 0 && gContactEndedCallback != nullptr) gContactEndedCallback(manifolds_[0]);
  }

  std::array<btPersistentManifold*, most_manifolds> manifolds_{};
  std::size_t manifold_count_ = 0;
  const TouchableShape* relief_ = nullptr;  // of the body, when it is textured itself
  contact::Shape shape_;                    // of the body; Bullet makes a new algorithm when it changes
  bool swapped_, reports_;
};

struct CreateSurface : btCollisionAlgorithmCreateFunc {
  CreateSurface(bool swapped, bool reports) : reports_(reports) { m_swapped = swapped; }
  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override {
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(SurfaceAlgorithm));
    // Of two textured ones the body is the one that moves.
    const auto is_textured = [](const btCollisionObjectWrapper& o) {
      return o.getCollisionShape()->getShapeType() == CUSTOM_CONCAVE_SHAPE_TYPE;
    };
    const bool turned =
        is_textured(*a) && is_textured(*b) && a->getCollisionObject()->isStaticOrKinematicObject();
    const bool swapped = m_swapped || turned;
    return new (memory) SurfaceAlgorithm(info, swapped ? *b : *a, swapped ? *a : *b, swapped, reports_);
  }
  bool reports_;
};

}  // namespace

void register_algorithms(btCollisionDispatcher& dispatcher) {
  static CreateSurface body_first(false, false), surface_first(true, false);
  static CreateSurface reports_body_first(false, true), reports_surface_first(true, true);
  for (int type = 0; type < MAX_BROADPHASE_COLLISION_TYPES; ++type) {
    // Compounds come apart in Bullet's own algorithm, which then asks for each child.
    if (btBroadphaseProxy::isCompound(type) || btBroadphaseProxy::isSoftBody(type)) continue;
    dispatcher.registerCollisionCreateFunc(type, CUSTOM_CONCAVE_SHAPE_TYPE, &body_first);
    dispatcher.registerClosestPointsCreateFunc(type, CUSTOM_CONCAVE_SHAPE_TYPE, &reports_body_first);
    if (type == CUSTOM_CONCAVE_SHAPE_TYPE) continue;
    dispatcher.registerCollisionCreateFunc(CUSTOM_CONCAVE_SHAPE_TYPE, type, &surface_first);
    dispatcher.registerClosestPointsCreateFunc(CUSTOM_CONCAVE_SHAPE_TYPE, type, &reports_surface_first);
  }
}

}  // namespace intaglio::dynamics
