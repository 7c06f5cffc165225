// Convex bodies as the greatest of their faces' planes: negative inside, where it is the distance to the
// nearest face; outside no more than the distance. Internal to contact/.
#pragma once

#include <cmath>

#include "intaglio/contact/question.h"
#include "intaglio/core/elementary.h"

namespace intaglio::contact {

// The face whose plane a point is highest over: a plane below the body's function everywhere, for that is
// convex.
struct SupportingPlane {
  Vec3 normal;    // unit, outwards
  double height;  // of the point, metres
  int face;
};

struct BoxPlanes {
  const Frame& frame;
  Vec3 half;

  SupportingPlane plane_at(const Vec3& x) const {
    const Vec3 local = frame.back(x);
    Eigen::Index axis = 0;
    const double height = (local.cwiseAbs() - half).maxCoeff(&axis);
    const double sign = local[axis] < 0 ? -1 : 1;
    return {sign * frame.axes.col(axis), height, static_cast<int>(2 * axis + (sign > 0 ? 1 : 0))};
  }
};

struct CylinderPlanes {
  const Frame& frame;
  double radius, half_height;

  SupportingPlane plane_at(const Vec3& x) const {
    const Vec3 local = frame.back(x);
    const double across = elementary::hypot(local.x(), local.z()), side = across - radius,
                 end = std::abs(local.y()) - half_height;
    if (end >= side || across == 0) {
      const double sign = local.y() < 0 ? -1 : 1;
      return {sign * frame.axes.col(1), end, sign > 0 ? 1 : 0};
    }
    return {frame.axes * Vec3(local.x() / across, 0, local.z() / across), side, 2};
  }
};

struct HullPlanes {
  const Frame& frame;
  const Polyhedron& form;

  SupportingPlane plane_at(const Vec3& x) const {
    const Vec3 local = frame.back(x);
    SupportingPlane out{Vec3::UnitY(), -1e300, 0};
    for (std::size_t k = 0; k < form.faces.size(); ++k) {
      const double height = form.faces[k].normal.dot(local) - form.faces[k].offset;
      if (height > out.height) out = {form.faces[k].normal, height, static_cast<int>(k)};
    }
    out.normal = frame.axes * out.normal;
    return out;
  }
};

}  // namespace intaglio::contact
