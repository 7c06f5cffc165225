// Textured shapes in your own Bullet world (3.24, single precision): one line more than for a plane.
//
//   intaglio::bullet::enable(dispatcher);              // once, before the first step
//   intaglio::bullet::SurfaceShape floor(intaglio::Surface::load("brick", {.size = {4, 4}}).value());
//   btRigidBody ground(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &floor));
//   world.addRigidBody(&ground);                       // examples/bullet_floor.cpp, bullet_bowl.cpp
//
// The shape outlives its bodies, as Bullet's shapes do; it shares the surface. A surface lies where its pose
// says in the shape's frame: leave the body's transform at the identity to have it there in the world. For a
// moving body with a curved surface the mesh's origin is the centre of mass, and its axes should be
// principal.
//
// Contacts are found anew in each step, ahead of the body along its motion, so that a fast body does not sink
// in; their impulses are kept by feature, for the solver's warm start. Boxes and other bodies that turn need
// steps of 1/240 s on deep relief: docs/library.md has the measurements. Ray casts and contactTest work.
// Spheres, boxes, capsules, cylinders, hulls, other convex shapes and compounds of them can touch a surface,
// and two surfaces can touch each other if one of them moves; docs/dynamics.md says how accurate each pair
// is. btSdfCollisionShape has the same type number: the two cannot be in one world. One thread at a time, as
// Bullet itself. Keep the scene within some hundred metres.
//
// A shape sets no friction and no restitution: they are the bodies', and Bullet multiplies those of a pair.
// Material::friction is for a pair the square root of the product, so give each body, the ground too,
//   body.setFriction(btScalar(std::sqrt(material.friction)));
//   body.setRestitution(btScalar(material.restitution));
// with Surface::material() or find_material(). Rolling friction combines as Bullet's own does.
//
// The only header of the library that includes Bullet; link intaglio::dynamics and Bullet.
#pragma once

#include <btBulletCollisionCommon.h>

#include <limits>
#include <memory>

#include "intaglio/error.h"
#include "intaglio/mesh.h"
#include "intaglio/representation.h"
#include "intaglio/surface.h"

namespace intaglio::dynamics {
class TexturedShapeBase;  // of the library
}

namespace intaglio::bullet {

// Registers the collision algorithms of SurfaceShape with every kind of shape, in both orders of a pair, for
// steps and for contactTest.
void enable(btCollisionDispatcher& dispatcher);

// Whether a Bullet shape can touch a SurfaceShape; the error names the shape and the reason: neither convex
// nor a compound of convex ones, or a hull without volume. A shape that cannot touch it passes through.
Result<void> check(const btCollisionShape& shape);

struct ShapeOptions {
  Representation representation = Representation::relief;  // of a rectangle; curved ones have their relief
  ContactMethod method = ContactMethod::closest;
  NormalMethod normal_method = NormalMethod::implied;
  double thickness =
      std::numeric_limits<double>::infinity();  // m: what is deeper below is behind it, not in it
};

// Call enable() on the world's dispatcher first: without it Bullet takes this shape for a
// btSdfCollisionShape, no error is reported, and bodies fall through.
class SurfaceShape final : public btConcaveShape {
 public:
  explicit SurfaceShape(const Surface& surface, const ShapeOptions& options = {});
  explicit SurfaceShape(const CurvedSurface& surface, const ShapeOptions& options = {});
  ~SurfaceShape() override;
  SurfaceShape(const SurfaceShape&) = delete;
  SurfaceShape& operator=(const SurfaceShape&) = delete;

  // The inertia of a rectangle is that of a slab as thick as its relief is deep; that of a closed mesh is its
  // volume's, without the products of inertia.
  void calculateLocalInertia(btScalar mass, btVector3& inertia) const override;
  void getAabb(const btTransform& transform, btVector3& low, btVector3& high) const override;
  void processAllTriangles(btTriangleCallback* callback, const btVector3& low,
                           const btVector3& high) const override;
  void setLocalScaling(const btVector3& scaling) override;  // has no effect: a surface is in metres
  const btVector3& getLocalScaling() const override;
  const char* getName() const override { return "SurfaceShape"; }

  // contact_status::no_size once a body that cannot touch this shape has met it: check() gives the reason.
  unsigned status() const;

  const dynamics::TexturedShapeBase& impl() const { return *impl_; }

 private:
  std::unique_ptr<dynamics::TexturedShapeBase> impl_;
};

}  // namespace intaglio::bullet
