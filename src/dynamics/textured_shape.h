// Textured surfaces as Bullet shapes, for any btDiscreteDynamicsWorld: TexturedShape on a rectangle,
// CurvedShape on a mesh, and the collision algorithms that both need.
//
// Includes Bullet (3.24, single precision). One thread at a time. Scenes larger than some hundred metres
// lose the finest relief to rounding.
#pragma once

#include <btBulletCollisionCommon.h>

#include <limits>
#include <memory>
#include <optional>

#include "contact/contact_point.h"
#include "contact/shape.h"
#include "dynamics/contact_options.h"
#include "intaglio/error.h"
#include "intaglio/representation.h"
#include "mesh/relief_mesh.h"
#include "surface/surface.h"

namespace intaglio::dynamics {

// A place on a shape's texture, in the shape's frame.
struct TextureSite {
  int texture = 0;              // index of the shape in its compound; 0 if it stands alone
  Vec2 uv = Vec2::Zero();       // 0..1
  Vec3 n_s = Vec3::UnitY();     // unit, normal of the map
  int triangle = -1;            // of a curved base; -1 on a rectangle
  Vec3 weights = Vec3::Zero();  // of the triangle's corners
};

// The texture of a curved relief at the place of its base under a point; absent when that is farther than
// `reach` metres.
std::optional<TextureSite> site_under(const surface::ReliefMesh& relief, const Vec3& point, double reach);

// Base of the textured shapes: what the collision algorithm needs of them.
class TexturedShapeBase : public btConcaveShape {
 public:
  static constexpr double unlimited_thickness = std::numeric_limits<double>::infinity();

  // Anything deeper under the relief than `thickness` metres is behind the shape, not in it.
  explicit TexturedShapeBase(double thickness = unlimited_thickness)
      : thickness_(thickness >= 0 ? thickness : unlimited_thickness) {
    m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE;  // by which Bullet finds the algorithm
    m_collisionMargin = 0;
  }

  // Where a body at `pose` in this shape's frame touches it, or will within `margin` metres.
  virtual contact::ContactSet contacts(const contact::Shape& body, const Pose& pose, double margin) const = 0;
  // The texture at one of those contacts; absent where there is none.
  virtual std::optional<TextureSite> site(const contact::ContactPoint& c) const = 0;
  // The texture at a point of the relief.
  virtual std::optional<TextureSite> site_at(const Vec3& point) const = 0;
  // Texel size, m.
  virtual double texel() const = 0;
  // Whether contacts are those of a plane, whatever their normals.
  virtual bool is_plane() const { return false; }

  double thickness() const { return thickness_; }
  // Drops contacts deeper than the thickness.
  contact::ContactSet within_thickness(contact::ContactSet set) const;
  // The largest margin for contacts(), m: bodies farther away are not looked at.
  double look_ahead() const { return look_ahead_; }
  bool is_near(const btVector3& low, const btVector3& high) const {
    return TestAabbAgainstAabb2(low, high, low_, high_);
  }

  // Bits of contact::status about bodies that met this shape: no_size if one of them cannot touch it, for
  // which check_shape() gives the reason.
  unsigned status() const { return status_; }
  void add_status(unsigned bits) const { status_ |= bits; }

  void getAabb(const btTransform& t, btVector3& low, btVector3& high) const override {
    // Bullet pairs what overlaps now; contacts are wanted before that.
    btTransformAabb(low_, high_, btScalar(look_ahead_), t, low, high);
  }
  void setLocalScaling(const btVector3&) override {}  // surfaces have a fixed size in metres
  const btVector3& getLocalScaling() const override { return scaling_; }

 protected:
  double look_ahead_ = 0;
  btVector3 low_{0, 0, 0}, high_{0, 0, 0};  // where bodies are looked for, in this shape's frame

 private:
  double thickness_;
  btVector3 scaling_{1, 1, 1};
  mutable unsigned status_ = 0;
};

// Where a textured body at `pose` in the ground's frame touches it: two rectangles, two curved bodies, or a
// curved body and a rectangle in either role.
contact::ContactSet relief_pair_contacts(const TexturedShapeBase& body, const Pose& pose,
                                         const TexturedShapeBase& ground, double margin);

// A textured rectangle:
//
//   dynamics::register_algorithms(dispatcher);           // once, before the first step
//   dynamics::TexturedShape floor(surface);              // must outlive its bodies
//   btRigidBody ground(0, nullptr, &floor);
//
// The surface's placement is in the shape's frame: leave the body's transform at the identity to have the
// surface where its placement says. Contacts are recomputed every step along the body's motion, so that fast
// bodies do not tunnel, and keep their impulses by feature for the solver's warm start. Friction, restitution
// and rolling friction combine as Bullet's own do. Ray casts and contactTest work. Supported pairs:
// docs/dynamics.md.
class TexturedShape : public TexturedShapeBase {
 public:
  explicit TexturedShape(std::shared_ptr<const surface::Surface> surface, const ContactOptions& options = {},
                         double thickness = unlimited_thickness);

  const surface::Surface& surface() const { return *surface_; }
  // The geometry that bodies touch: the surface, or the relief that its normals imply.
  const surface::Surface& relief() const { return *relief_; }
  Vec2 mean_slope() const { return mean_slope_; }  // of the implied relief

  // A body entirely under the relief is pushed out if it is no deeper than look_ahead() or the thickness.
  contact::ContactSet contacts(const contact::Shape& body, const Pose& pose, double margin) const override;
  std::optional<TextureSite> site(const contact::ContactPoint& c) const override;
  std::optional<TextureSite> site_at(const Vec3& point) const override;
  double texel() const override { return std::min(surface_->texel_u(), surface_->texel_v()); }
  bool is_plane() const override {
    return options_.representation == Representation::flat ||
           (options_.representation == Representation::normal &&
            options_.normal_method == NormalMethod::literal);
  }

  // That of a slab as thick as the relief is deep, at least a hundredth of its side.
  void calculateLocalInertia(btScalar mass, btVector3& inertia) const override;
  const char* getName() const override { return "TexturedShape"; }
  // Two triangles a cell, for ray casts and soft bodies.
  void processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                           const btVector3& high) const override;

 private:
  contact::ContactSet all_contacts(const contact::Shape& body, const Pose& pose, double margin) const;

  std::shared_ptr<const surface::Surface> surface_, relief_;
  Vec2 mean_slope_ = Vec2::Zero();
  ContactOptions options_;
};

// A relief on a curved base: a bowl, a pipe, a ball with a texture.
//
//   dynamics::register_algorithms(dispatcher);   // once, before the first step
//   dynamics::CurvedShape bowl(relief);          // surface::ReliefMesh::make
//   btRigidBody ground(0, nullptr, &bowl);
//
// The mesh's coordinates are those of the shape: for a body that moves, its origin is the centre of mass, and
// its axes should be principal. Contacts with Bullet's shapes: contact/curved_contacts.h (not
// btStaticPlaneShape: use a flat TexturedShape); with the textured shapes: contact/curved_body.h. Two curved
// shapes are expensive. Ray casts hit the mesh with its corners moved to the relief.
class CurvedShape : public TexturedShapeBase {
 public:
  explicit CurvedShape(surface::ReliefMesh relief, double thickness = unlimited_thickness);

  const surface::ReliefMesh& relief() const { return relief_; }
  contact::ContactSet contacts(const contact::Shape& body, const Pose& pose, double margin) const override;
  std::optional<TextureSite> site(const contact::ContactPoint& c) const override;
  std::optional<TextureSite> site_at(const Vec3& point) const override;
  double texel() const override { return relief_.texel_size(); }

  // For the volume inside a closed mesh, its corners moved to the relief; zero for an open mesh.
  contact::MassProperties mass_properties() const;
  // About the origin (diagonal only); for an open mesh, that of its bounding box.
  void calculateLocalInertia(btScalar mass, btVector3& inertia) const override;
  const char* getName() const override { return "CurvedShape"; }
  void processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                           const btVector3& high) const override;

 private:
  surface::ReliefMesh relief_;
};

// Registers the collision algorithms for TexturedShape and CurvedShape with every kind of shape, in both
// orders of a pair, for steps and for contactTest. btSdfCollisionShape uses the same shape type: the two
// cannot be in one world.
void register_algorithms(btCollisionDispatcher& dispatcher);

// Whether a Bullet shape can touch textured ones; the error names the shape and the reason. One that cannot
// passes through them; TexturedShapeBase::status() and, in debug builds, an assert report it.
Result<void> check_shape(const btCollisionShape& shape);

// Knowledge of the contact query about one manifold point.
struct ContactRecord {
  std::uint64_t feature = 0;  // contact::ContactPoint::feature
  // When the contact closed, s after the start of the step; negative if it closed in the step before and is
  // resolved in this one. Unset unless it has just closed.
  std::optional<double> touch_time;
  std::optional<TextureSite> on_a, on_b;  // textures of the manifold's two bodies
};

// Registers the algorithms, and keeps their records for programs that read the manifolds after a step. Must
// outlive the world's pairs.
class ContactRecords {
 public:
  explicit ContactRecords(btCollisionDispatcher& dispatcher);
  ~ContactRecords();

  // Absent for contacts that Bullet's own algorithms found. Valid until the next step.
  const ContactRecord* find(const btPersistentManifold& manifold, const btManifoldPoint& point) const;

  struct Algorithms;  // internal
  struct Table;

 private:
  std::unique_ptr<Table> table_;
  std::unique_ptr<Algorithms> algorithms_;
};

}  // namespace intaglio::dynamics
