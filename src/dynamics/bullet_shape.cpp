#include "dynamics/bullet_shape.h"

#include <cmath>
#include <numbers>

#include "core/portable_math.h"
#include "intaglio/vec.h"

namespace intaglio::dynamics {

namespace {

// A shape round Y, turned round another axis.
contact::Shape along(const contact::Shape& shape, int axis) {
  if (axis == 1) return shape;
  const Vec3 to = axis == 0 ? Vec3::UnitX() : Vec3::UnitZ();
  return contact::make_compound({{shape, {Vec3::Zero(), rotation_onto(Vec3::UnitY(), to)}}});
}

contact::Shape from_compound(const btCompoundShape& shape) {
  std::vector<contact::CompoundChild> children;
  for (int k = 0; k < shape.getNumChildShapes(); ++k)
    children.push_back({from_bullet(*shape.getChildShape(k)), from_bullet(shape.getChildTransform(k))});
  return contact::make_compound(std::move(children));
}

// Nothing that can be touched.
const contact::Shape nothing = contact::Sphere{0};

contact::Shape hull_of(const std::vector<Vec3>& points) {
  const auto form = contact::convex_hull(points);
  return form ? contact::Shape(contact::ConvexHull{*form}) : nothing;
}

// A concave mesh: for Bullet its hull, for us itself.
class MeshShape : public btConvexHullShape {
 public:
  explicit MeshShape(const contact::Mesh& mesh) : mesh_(mesh) {}
  const contact::Mesh& mesh() const { return mesh_; }

 private:
  contact::Mesh mesh_;
};

contact::Shape from_hull(const btConvexHullShape& hull) {
  if (const auto* mesh = dynamic_cast<const MeshShape*>(&hull)) return mesh->mesh();
  std::vector<Vec3> points;
  for (int k = 0; k < hull.getNumPoints(); ++k) points.push_back(from_bullet(hull.getScaledPoint(k)));
  return hull_of(points);
}

// Any convex shape, by the points that are farthest along directions spread evenly over a sphere.
contact::Shape from_convex(const btConvexShape& shape) {
  constexpr int directions = 42;
  std::vector<Vec3> points;
  for (int k = 0; k < directions; ++k) {
    const double z = 1 - (2 * k + 1.0) / directions, angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
    const double across = std::sqrt(1 - z * z);
    const Vec3 direction(across * elementary::cos(angle), across * elementary::sin(angle), z);
    points.push_back(from_bullet(shape.localGetSupportingVertex(to_bullet(direction))));
  }
  return hull_of(points);
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
    case CONVEX_HULL_SHAPE_PROXYTYPE:
      return from_hull(static_cast<const btConvexHullShape&>(shape));
    default:
      return shape.isConvex() ? from_convex(static_cast<const btConvexShape&>(shape)) : nothing;
  }
}

namespace {

using Part = std::unique_ptr<btCollisionShape>;

Part hull_shape(std::unique_ptr<btConvexHullShape> hull, const contact::Polyhedron& form) {
  for (const Vec3& v : form.vertices) hull->addPoint(to_bullet(v), false);
  hull->recalcLocalAabb();
  // Bullet rounds hulls by a margin of 4 cm if left alone.
  hull->setMargin(static_cast<btScalar>(1e-3 * form.radius));
  return hull;
}

struct MakePart {
  btScalar f(double x) const { return static_cast<btScalar>(x); }
  Part operator()(const contact::Sphere& s) const { return std::make_unique<btSphereShape>(f(s.radius)); }
  Part operator()(const contact::Capsule& s) const {
    return std::make_unique<btCapsuleShape>(f(s.radius), f(2 * s.half_height));
  }
  Part operator()(const contact::Box& s) const { return std::make_unique<btBoxShape>(to_bullet(s.half)); }
  Part operator()(const contact::Cylinder& s) const {
    return std::make_unique<btCylinderShape>(to_bullet(Vec3(s.radius, s.half_height, s.radius)));
  }
  Part operator()(const contact::ConvexHull& s) const {
    return hull_shape(std::make_unique<btConvexHullShape>(), *s.form);
  }
  Part operator()(const contact::Mesh& s) const {
    return hull_shape(std::make_unique<MeshShape>(s), *s.form);
  }
  Part operator()(const contact::Compound&) const { return nullptr; }
};

// Adds the parts of a shape that is at `pose` to a compound.
void add_parts(const contact::Shape& shape, const Pose& pose, btCompoundShape& compound,
               std::vector<Part>& parts) {
  if (const auto* inner = std::get_if<contact::Compound>(&shape)) {
    for (const contact::CompoundChild& child : *inner->children)
      add_parts(child.shape, {pose.to_world(child.pose.position), pose.orientation * child.pose.orientation},
                compound, parts);
    return;
  }
  parts.push_back(std::visit(MakePart{}, shape));
  compound.addChildShape(to_bullet(pose), parts.back().get());
}

}  // namespace

BulletShape to_bullet(const contact::Shape& shape, const Pose& pose) {
  BulletShape out;
  const bool in_place = pose.position.isZero() && pose.orientation.vec().isZero();
  if (in_place && !std::holds_alternative<contact::Compound>(shape)) {
    out.parts.push_back(std::visit(MakePart{}, shape));
    return out;
  }
  auto compound = std::make_unique<btCompoundShape>();
  add_parts(shape, pose, *compound, out.parts);
  out.parts.push_back(std::move(compound));
  return out;
}

}  // namespace intaglio::dynamics
