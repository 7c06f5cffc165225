// A relief on a curved base as a Bullet shape: a bowl, a pipe, a ball with a texture. Drop it into any
// btDiscreteDynamicsWorld, as TexturedShape (textured_shape.h), whose algorithms it shares:
//
//   dynamics::register_algorithms(dispatcher);   // once, before the first step
//   dynamics::CurvedShape bowl(relief);          // surface::ReliefMesh::make
//   btRigidBody ground(0, nullptr, &bowl);
//
// The mesh's coordinates are those of the shape: for a body that moves, its origin is the centre of mass, and
// its axes should be principal. Meets Bullet's shapes as contact/curved_relief.h says (not
// btStaticPlaneShape: use a TexturedShape without relief), and a TexturedShape as curved_on_relief.h says,
// either moving, and another CurvedShape as curved_on_curved.h says, which is dear. Ray casts meet the mesh
// with its corners moved to the relief.
//
// Includes Bullet (3.24, single precision). One thread at a time.
#pragma once

#include "intaglio/contact/mass.h"
#include "intaglio/dynamics/touchable_shape.h"
#include "intaglio/surface/mesh/relief_mesh.h"

namespace intaglio::dynamics {

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
