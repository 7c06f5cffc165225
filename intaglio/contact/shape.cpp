#include "intaglio/contact/shape.h"

#include <algorithm>

#include "intaglio/core/elementary.h"

namespace intaglio::contact {

namespace {

struct BoundingRadius {
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Capsule& s) const { return s.half_height + s.radius; }
  double operator()(const Box& s) const { return s.half.norm(); }
  double operator()(const Cylinder& s) const { return elementary::hypot(s.radius, s.half_height); }
  double operator()(const ConvexHull& s) const { return s.form ? s.form->radius : 0; }
  double operator()(const Mesh& s) const { return s.form ? s.form->radius : 0; }
  double operator()(const Compound& s) const {
    double radius = 0;
    if (s.children)
      for (const CompoundChild& c : *s.children)
        radius = std::max(radius, c.pose.position.norm() + bounding_radius(c.shape));
    return radius;
  }
};

}  // namespace

double bounding_radius(const Shape& shape) {
  return std::visit(BoundingRadius{}, shape);
}

}  // namespace intaglio::contact
