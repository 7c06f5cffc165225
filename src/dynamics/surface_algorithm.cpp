// The collision algorithm for any shape against a TexturedShape or CurvedShape, and its records.
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <typeinfo>
#include <unordered_map>

#include "dynamics/approach.h"
#include "dynamics/bullet_shape.h"
#include "dynamics/textured_shape.h"
#include "intaglio/bullet.h"

namespace intaglio::dynamics {

namespace {

// Material coefficients of the pair, combined by Bullet's rules.
btManifoldPoint combined(const btCollisionObject& body, const btCollisionObject& textured) {
  btManifoldPoint out{btVector3(0, 0, 0), btVector3(0, 0, 0), btVector3(0, 1, 0), 0};
  out.m_combinedFriction = btManifoldResult::calculateCombinedFriction(&body, &textured);
  out.m_combinedRestitution = btManifoldResult::calculateCombinedRestitution(&body, &textured);
  out.m_combinedRollingFriction = btManifoldResult::calculateCombinedRollingFriction(&body, &textured);
  out.m_combinedSpinningFriction = btManifoldResult::calculateCombinedSpinningFriction(&body, &textured);
  return out;
}

double gravity_of(const btCollisionObject& object) {
  const btRigidBody* body = btRigidBody::upcast(&object);
  return body == nullptr ? 0 : double(body->getGravity().length());
}

bool is_textured(const btCollisionShape& shape) {
  return shape.getShapeType() == CUSTOM_CONCAVE_SHAPE_TYPE;
}

// The shape that a user's SurfaceShape holds, or one of the world's own. Asked for each pair and step: a
// dynamic_cast would take a tenth of a ball's time on a plane. SurfaceShape is final.
const TexturedShapeBase& textured_shape(const btCollisionShape& shape) {
  if (typeid(shape) == typeid(bullet::SurfaceShape))
    return static_cast<const bullet::SurfaceShape&>(shape).impl();
  return static_cast<const TexturedShapeBase&>(shape);
}

using Records = std::array<ContactRecord, contact::ContactSet::capacity>;

}  // namespace

struct ContactRecords::Table {
  std::unordered_map<const btPersistentManifold*, const Records*> of;
};

namespace {

class SurfaceAlgorithm : public btCollisionAlgorithm {
 public:
  // `is_query`: for contactTest() and the like, which want points and no step.
  SurfaceAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper& body,
                   const btCollisionObjectWrapper& textured, bool swapped, bool is_query,
                   ContactRecords::Table* table)
      : btCollisionAlgorithm(info),
        records_(is_query ? nullptr : std::make_unique<Records>()),
        table_(table),
        swapped_(swapped),
        is_query_(is_query) {
    const btCollisionShape& shape = *body.getCollisionShape();
    if (is_textured(shape)) {
      relief_ = &textured_shape(shape);
    } else if (const auto made = from_bullet(shape)) {
      shape_ = *made;
    } else {
      textured_shape(*textured.getCollisionShape()).add_status(contact::status::no_size);
      assert(!"a Bullet shape passes through textured ones: dynamics::check_shape() says why");
    }
    add_manifold(*body.getCollisionObject(), *textured.getCollisionObject());
  }
  ~SurfaceAlgorithm() override {
    for (std::size_t k = 0; k < manifold_count_; ++k) {
      if (table_ != nullptr) table_->of.erase(manifolds_[k]);
      m_dispatcher->releaseManifold(manifolds_[k]);
    }
  }

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override {
    const btCollisionObjectWrapper& body = swapped_ ? *b : *a;
    const btCollisionObjectWrapper& textured = swapped_ ? *a : *b;
    const TexturedShapeBase& shape = textured_shape(*textured.getCollisionShape());
    if (is_query_) return report(shape, body, textured, *result);
    const Approach approach(body, textured, double(info.m_timeStep));
    const double slack = 0.01 * std::min(shape.texel(), approach.reach);
    ContactsAhead contacts;
    if (is_near(shape, approach)) contacts = contacts_of(shape, approach, slack);
    std::array<double, contact::ContactSet::capacity> gaps{};
    for (std::size_t k = 0; k < contacts.count; ++k) gaps[k] = contacts.points[k].distance;
    const auto add_sites = [&](std::size_t k, ContactRecord& record) {
      if (table_ == nullptr) return;  // only the world, which has the table, reads them
      set_sites(contacts.points[k], gaps[k], shape, approach, body.m_index, textured.m_index, record);
    };
    if (relief_ != nullptr || (is_free(body) && is_free(textured))) tolerate_overlap(contacts, slack);
    fill(contacts, add_sites, approach, slack, *body.getCollisionObject(), *textured.getCollisionObject(),
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
  static constexpr std::size_t max_manifolds =
      (contact::ContactSet::capacity + per_manifold - 1) / per_manifold;
  // The points of the step before, as far as they carry over.
  struct OldPoint {
    std::uint64_t feature;
    btScalar impulse;
    int life_time;
  };
  struct OldPoints {
    std::array<OldPoint, contact::ContactSet::capacity> points;
    std::size_t count = 0;

    const OldPoint* find(std::uint64_t feature) const {
      for (std::size_t k = 0; k < count; ++k)
        if (points[k].feature == feature) return &points[k];
      return nullptr;
    }
  };
  // The body is always A, so that impulses act on it.
  void add_manifold(const btCollisionObject& body, const btCollisionObject& textured) {
    btPersistentManifold* added = m_dispatcher->getNewManifold(&body, &textured);
    if (table_ != nullptr) table_->of[added] = records_.get();
    manifolds_[manifold_count_++] = added;
  }

  static bool is_near(const TexturedShapeBase& shape, const Approach& approach) {
    const double far = approach.reach + std::min(approach.travel(), shape.look_ahead()) + 1e-3;
    const Vec3 away = Vec3::Constant(far);
    return shape.is_near(to_bullet(Vec3(approach.pose.position - away)),
                         to_bullet(Vec3(approach.pose.position + away)));
  }

  static bool is_free(const btCollisionObjectWrapper& one) {
    return !one.getCollisionObject()->isStaticOrKinematicObject();
  }

  // Matching reliefs touch in many places, and the reported points change from step to step. Correcting
  // overlaps that nobody sees would lift and drop the bodies and make piles jitter: up to `overlap` is
  // ignored.
  void tolerate_overlap(contact::ContactSet& contacts, double overlap) const {
    if (relief_ != nullptr) overlap = std::min(overlap, 0.01 * relief_->texel());
    for (std::size_t k = 0; k < contacts.count; ++k)
      if (double& d = contacts.points[k].distance; d < 0) d = std::min(d + overlap, 0.0);
  }

  ContactsAhead contacts_of(const TexturedShapeBase& shape, const Approach& approach, double slack) const {
    if (relief_ == nullptr) return contacts_ahead(shape, shape_, approach, slack);
    return relief_pair_contacts(*relief_, approach.pose, shape,
                                std::min(approach.travel() + slack, shape.texel()));
  }

  // The textures of body and textured shape at a contact; `gap` is its true distance.
  void set_sites(const contact::ContactPoint& c, double gap, const TexturedShapeBase& shape,
                 const Approach& approach, int body_child, int textured_child, ContactRecord& record) const {
    record.on_b = shape.site(c);
    if (record.on_b) record.on_b->texture = std::max(textured_child, 0);
    record.on_a.reset();
    if (relief_ == nullptr) return;
    record.on_a = relief_->site_at(approach.pose.to_local(c.point + gap * c.normal));
    if (record.on_a) record.on_a->texture = std::max(body_child, 0);
  }

  // contactTest() and similar queries collect points themselves; body B is the manifold's second.
  void report(const TexturedShapeBase& shape, const btCollisionObjectWrapper& body,
              const btCollisionObjectWrapper& textured, btManifoldResult& result) const {
    result.setPersistentManifold(manifolds_[0]);
    const btTransform& frame = textured.getWorldTransform();
    const Pose pose = from_bullet(frame.inverseTimes(body.getWorldTransform()));
    const auto margin = double(result.m_closestPointDistanceThreshold);
    const contact::ContactSet found = relief_ != nullptr ? relief_pair_contacts(*relief_, pose, shape, margin)
                                                         : shape.contacts(shape_, pose, margin);
    for (const contact::ContactPoint& c : found) {
      const btVector3 normal = frame.getBasis() * to_bullet(c.normal);
      const btVector3 on_surface = frame(to_bullet(c.point));
      result.addContactPoint(normal, on_surface, btScalar(c.distance));
    }
  }

  // Rebuilt each step, as Bullet's cached points would keep stale normals; impulses stay with their feature.
  template <class AddSites>
  void fill(const ContactsAhead& contacts, const AddSites& add_sites, const Approach& approach, double slack,
            const btCollisionObject& body, const btCollisionObject& textured, const btTransform& frame) {
    const OldPoints old = old_points();
    btManifoldPoint point = combined(body, textured);
    const PlannedContacts plan = plan_contacts(contacts, approach, double(point.m_combinedRestitution),
                                               min_bounce_speed(gravity_of(body), approach.dt), slack);
    std::size_t count = 0;
    for (std::size_t k = 0; k < contacts.count; ++k) {
      const contact::ContactPoint& c = contacts.points[k];
      const OldPoint* before = old.find(c.feature);
      // A new contact cannot be deeper than the body moved in this step.
      const bool is_new = before == nullptr && old.count > 0 && contacts.count > 1;
      if (is_new && plan[k].distance < -(approach.travel() + 0.02 * approach.reach)) continue;
      if (plan[k].is_deferred) continue;
      point.m_combinedRestitution = btScalar(plan[k].restitution);
      point.m_normalWorldOnB = frame.getBasis() * to_bullet(c.normal);
      point.m_positionWorldOnB = frame(to_bullet(c.point));
      point.m_distance1 = btScalar(plan[k].distance);
      point.m_positionWorldOnA = point.m_positionWorldOnB + point.m_normalWorldOnB * point.m_distance1;
      point.m_localPointA = body.getWorldTransform().invXform(point.m_positionWorldOnA);
      point.m_localPointB = textured.getWorldTransform().invXform(point.m_positionWorldOnB);
      point.m_appliedImpulse = before ? before->impulse : 0;
      point.m_lifeTime = before ? before->life_time + 1 : 0;
      const bool was_pressed = before && before->impulse > 0;
      const bool goes_on = was_pressed && c.distance <= slack;
      ContactRecord& record = (*records_)[count];
      record.feature = c.feature;
      record.touch_time = goes_on ? std::nullopt : plan[k].touch_time;
      add_sites(k, record);
      place(point, count++, body, textured);
    }
    for (std::size_t m = 0; m < manifold_count_; ++m)
      manifolds_[m]->setNumContacts(int(std::min(count - std::min(count, m * per_manifold), per_manifold)));
    notify_listeners(old.count, count);
  }

  OldPoints old_points() const {
    OldPoints old;
    for (std::size_t m = 0; m < manifold_count_; ++m) {
      for (int k = 0; k < manifolds_[m]->getNumContacts(); ++k) {
        const btManifoldPoint& point = manifolds_[m]->getContactPoint(k);
        const std::uint64_t feature = (*records_)[std::size_t(point.m_index1)].feature;
        old.points[old.count++] = {feature, point.m_appliedImpulse, point.m_lifeTime};
      }
    }
    return old;
  }

  // Stores the contact as point `k` of the pair. Bullet's compounds drop points and move others into their
  // places, so each point carries the number of its record, in m_index1, which Bullet uses for a shape's
  // touched part.
  void place(btManifoldPoint& point, std::size_t k, const btCollisionObject& body,
             const btCollisionObject& textured) {
    const std::size_t m = k / per_manifold, at = k % per_manifold;
    if (m == manifold_count_) add_manifold(body, textured);
    point.m_index1 = int(k);
    manifolds_[m]->setNumContacts(int(at) + 1);
    manifolds_[m]->getContactPoint(int(at)) = point;
  }

  // Calls Bullet's contact callbacks as its own algorithms do.
  void notify_listeners(std::size_t before, std::size_t after) const {
    if (before == 0 && after > 0 && gContactStartedCallback != nullptr)
      gContactStartedCallback(manifolds_[0]);
    if (before > 0 && after == 0 && gContactEndedCallback != nullptr) gContactEndedCallback(manifolds_[0]);
  }

  std::array<btPersistentManifold*, max_manifolds> manifolds_{};
  std::size_t manifold_count_ = 0;
  const TexturedShapeBase* relief_ = nullptr;  // of the body, when it is textured itself
  contact::Shape shape_;  // of the body otherwise; Bullet makes a new algorithm when it changes
  std::unique_ptr<Records> records_;
  ContactRecords::Table* table_;
  bool swapped_, is_query_;
};

// Bullet's allocator of algorithms has room for its own and checks sizes in debug builds only.
static_assert(sizeof(SurfaceAlgorithm) <=
              std::max(sizeof(btConvexConvexAlgorithm), sizeof(btCompoundCollisionAlgorithm)));

}  // namespace

struct ContactRecords::Algorithms {
  struct CreateSurface : btCollisionAlgorithmCreateFunc {
    CreateSurface(bool swapped, bool is_query, ContactRecords::Table* table)
        : is_query_(is_query), table_(table) {
      m_swapped = swapped;
    }
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override {
      void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(SurfaceAlgorithm));
      // If both are textured, the moving one is the body.
      const bool is_turned = is_textured(*a->getCollisionShape()) && is_textured(*b->getCollisionShape()) &&
                             a->getCollisionObject()->isStaticOrKinematicObject();
      const bool swapped = m_swapped || is_turned;
      return new (memory)
          SurfaceAlgorithm(info, swapped ? *b : *a, swapped ? *a : *b, swapped, is_query_, table_);
    }
    bool is_query_;
    ContactRecords::Table* table_;
  };

  CreateSurface body_first, surface_first, query_body_first, query_surface_first;

  explicit Algorithms(Table* table)
      : body_first(false, false, table),
        surface_first(true, false, table),
        query_body_first(false, true, nullptr),
        query_surface_first(true, true, nullptr) {}

  void register_in(btCollisionDispatcher& dispatcher) {
    for (int type = 0; type < MAX_BROADPHASE_COLLISION_TYPES; ++type) {
      // Bullet's compound algorithm dispatches each child separately.
      if (btBroadphaseProxy::isCompound(type) || btBroadphaseProxy::isSoftBody(type)) continue;
      dispatcher.registerCollisionCreateFunc(type, CUSTOM_CONCAVE_SHAPE_TYPE, &body_first);
      dispatcher.registerClosestPointsCreateFunc(type, CUSTOM_CONCAVE_SHAPE_TYPE, &query_body_first);
      if (type == CUSTOM_CONCAVE_SHAPE_TYPE) continue;
      dispatcher.registerCollisionCreateFunc(CUSTOM_CONCAVE_SHAPE_TYPE, type, &surface_first);
      dispatcher.registerClosestPointsCreateFunc(CUSTOM_CONCAVE_SHAPE_TYPE, type, &query_surface_first);
    }
  }
};

void register_algorithms(btCollisionDispatcher& dispatcher) {
  static ContactRecords::Algorithms algorithms(nullptr);
  algorithms.register_in(dispatcher);
}

ContactRecords::ContactRecords(btCollisionDispatcher& dispatcher)
    : table_(std::make_unique<Table>()), algorithms_(std::make_unique<Algorithms>(table_.get())) {
  algorithms_->register_in(dispatcher);
}

ContactRecords::~ContactRecords() = default;

const ContactRecord* ContactRecords::find(const btPersistentManifold& manifold,
                                          const btManifoldPoint& point) const {
  const auto found = table_->of.find(&manifold);
  return found == table_->of.end() ? nullptr : &(*found->second)[std::size_t(point.m_index1)];
}

}  // namespace intaglio::dynamics
