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
#pragma once

#include <btBulletCollisionCommon.h>

#include <memory>

#include "intaglio/contact/contact_point.h"
#include "intaglio/contact/shape.h"
#include "intaglio/dynamics/method.h"
#include "intaglio/dynamics/touchable_shape.h"
#include "intaglio/surface/surface.h"

namespace intaglio::dynamics {

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

}  // namespace intaglio::dynamics
