// What our algorithm in Bullet asks of a textured shape, flat or curved.
//
// Includes Bullet. One thread at a time.
#pragma once

#include <btBulletCollisionCommon.h>

#include <limits>
#include <memory>

#include "contact/contact_point.h"
#include "contact/shape.h"
#include "dynamics/contact_options.h"
#include "intaglio/representation.h"
#include "mesh/relief_mesh.h"
#include "surface/surface.h"

namespace intaglio::dynamics {

class TouchableShape : public btConcaveShape {
 public:
  // What is below the relief is solid, however deep.
  static constexpr double solid = std::numeric_limits<double>::infinity();

  // Bullet looks algorithms up by this number, and knows that such a shape is concave. What is under the
  // relief by more than `thickness` metres is behind the shape, not in it.
  explicit TouchableShape(double thickness = solid) : thickness_(thickness >= 0 ? thickness : solid) {
    m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE;
    m_collisionMargin = 0;
  }

  // Where a body that is at `pose` in this shape's frame touches it, or will within `margin` metres.
  virtual contact::ContactSet contacts(const contact::Shape& body, const Pose& pose, double margin) const = 0;
  // The scale of its detail, metres.
  virtual double texel() const = 0;
  // Whether contacts are those of a plane, whatever their normals.
  virtual bool is_plane() const { return false; }
  double thickness() const { return thickness_; }
  // Without what is deeper than the shape is thick.
  contact::ContactSet within_thickness(contact::ContactSet set) const;
  // How far ahead contacts may be asked for, metres: bodies farther off are not looked at.
  double look_ahead() const { return look_ahead_; }
  bool is_near(const btVector3& low, const btVector3& high) const {
    return TestAabbAgainstAabb2(low, high, low_, high_);
  }

  void getAabb(const btTransform& t, btVector3& low, btVector3& high) const override {
    // Bullet pairs what overlaps now; contacts are wanted before that.
    btTransformAabb(low_, high_, static_cast<btScalar>(look_ahead_), t, low, high);
  }
  void setLocalScaling(const btVector3&) override {}  // a surface has metres; make another one
  const btVector3& getLocalScaling() const override { return scaling_; }

 protected:
  double look_ahead_ = 0;
  btVector3 low_{0, 0, 0}, high_{0, 0, 0};  // what bodies are looked for in, in this shape's frame

 private:
  double thickness_;
  btVector3 scaling_{1, 1, 1};
};

// Where a textured body at `pose` in the ground's frame touches it: two rectangles, two curved bodies, or a
// curved body and a rectangle in either role.
contact::ContactSet touch_of_reliefs(const TouchableShape& body, const Pose& pose,
                                     const TouchableShape& ground, double margin);

// A textured rectangle as a Bullet shape: drop it into any btDiscreteDynamicsWorld.
//
//   dynamics::register_algorithms(dispatcher);           // once, before the first step
//   dynamics::TexturedShape floor(surface);              // must outlive its bodies
//   btRigidBody ground(0, nullptr, &floor);
//
// The surface's placement is in the shape's frame: leave the body's transform at the identity to have the
// surface where its placement says. Contacts are found afresh in each step by contact/ (ahead of the body,
// along its motion, so that a fast one does not sink) and keep their impulses by feature for the solver's
// warm start. Friction, restitution and rolling friction combine as Bullet's own do. Ray casts and
// contactTest work. Spheres, boxes, capsules, cylinders, hulls, other convex shapes and compounds of them;
// what each meets: docs/dynamics.md.
//
// Includes Bullet (3.24, single precision). One thread at a time. Scenes larger than some hundred metres
// lose the finest relief to rounding.

class TexturedShape : public TouchableShape {
 public:
  explicit TexturedShape(std::shared_ptr<const surface::Surface> surface, const ContactOptions& options = {},
                         double thickness = solid);

  const surface::Surface& surface() const { return *surface_; }
  // What bodies move on: the surface, or the relief that its normals imply.
  const surface::Surface& relief() const { return *relief_; }
  Vec2 mean_slope() const { return mean_slope_; }  // of the implied relief
  const ContactOptions& options() const { return options_; }

  // A body that is wholly under the relief is lifted out of it from as far down as look_ahead(), or as the
  // shape is thick.
  contact::ContactSet contacts(const contact::Shape& body, const Pose& pose, double margin) const override;
  double texel() const override { return std::min(surface_->texel_u(), surface_->texel_v()); }

  bool is_plane() const override {
    return options_.representation == Representation::flat ||
           (options_.representation == Representation::normal &&
            options_.normal_method == NormalMethod::literal);
  }

  // Of a slab as thick as the relief is deep, but a hundredth of its side at least.
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

// Teaches `dispatcher` to meet every kind of shape with TexturedShape and CurvedShape, in both orders of a
// pair, for steps and for contactTest. Bullet gives btSdfCollisionShape the same number: the two cannot be in
// one world.
void register_algorithms(btCollisionDispatcher& dispatcher);

// A relief on a curved base as a Bullet shape: a bowl, a pipe, a ball with a texture. Drop it into any
// btDiscreteDynamicsWorld, as TexturedShape (textured_shape.h), whose algorithms it shares:
//
//   dynamics::register_algorithms(dispatcher);   // once, before the first step
//   dynamics::CurvedShape bowl(relief);          // surface::ReliefMesh::make
//   btRigidBody ground(0, nullptr, &bowl);
//
// The mesh's coordinates are those of the shape: for a body that moves, its origin is the centre of mass, and
// its axes should be principal. Meets Bullet's shapes as contact/curved_relief.h says (not
// btStaticPlaneShape: use a TexturedShape without relief), and a TexturedShape as curved_body.h says,
// either moving, and another CurvedShape as curved_body.h says, which is dear. Ray casts meet the mesh
// with its corners moved to the relief.
//
// Includes Bullet (3.24, single precision). One thread at a time.

class CurvedShape : public TouchableShape {
 public:
  explicit CurvedShape(surface::ReliefMesh relief, double thickness = solid);

  const surface::ReliefMesh& relief() const { return relief_; }
  contact::ContactSet contacts(const contact::Shape& body, const Pose& pose, double margin) const override;
  double texel() const override { return relief_.texel(); }

  // What a closed mesh encloses, its corners moved to the relief; of an open mesh nothing.
  contact::MassProperties enclosed() const;
  // Of that, about the origin: the diagonal only. Of an open mesh that of its bounding box.
  void calculateLocalInertia(btScalar mass, btVector3& inertia) const override;
  const char* getName() const override { return "CurvedShape"; }
  void processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                           const btVector3& high) const override;

 private:
  surface::ReliefMesh relief_;
};

}  // namespace intaglio::dynamics
