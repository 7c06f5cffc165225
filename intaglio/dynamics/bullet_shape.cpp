#include "intaglio/dynamics/bullet_shape.h"

#include <numbers>

#include "intaglio/dynamics/bullet_vec.h"

namespace intaglio::dynamics {

namespace {

// A shape round Y, turned round another axis.
contact::Shape along(const contact::Shape& shape, int axis) {
  if (axis == 1) return shape;
  const Vec3 to = axis == 0 ? Vec3::UnitX() : Vec3::UnitZ();
  return contact::make_compound({{shape, {Vec3::Zero(), Quat::FromTwoVectors(Vec3::UnitY(), to)}}});
}

contact::Shape from_compound(const btCompoundShape& shape) {
  std::vector<contact::CompoundChild> children;
  for (int k = 0; k < shape.getNumChildShapes(); ++k)
    children.push_back({from_bullet(*shape.getChildShape(k)), from_bullet(shape.getChildTransform(k))});
  return contact::make_compound(std::move(children));
}

}  // namespace

contact::Shape from_bullet(const btCollisionShape& shape) {
  switch (shape.getShapeType()) {
    case SPHERE_SHAPE_PROXYTYPE:
      return contact::Sphere{static_cast<const btSphereShape&>(shape).getRadius()};
    case BOX_SHAPE_PROXYTYPE:
      return contact::Box{from_bullet(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin())};
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      return along(contact::Capsule{capsule.getRadius(), capsule.getHalfHeight()}, capsule.getUpAxis());
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      const int axis = cylinder.getUpAxis();
      return along(contact::Cylinder{cylinder.getRadius(), cylinder.getHalfExtentsWithMargin()[axis]}, axis);
    }
    case COMPOUND_SHAPE_PROXYTYPE:
      return from_compound(static_cast<const btCompoundShape&>(shape));
    default:
      return contact::Sphere{0};
  }
}

}  // namespace intaglio::dynamics
