// How low and how high a body reaches. Internal to contact/.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "contact/query.h"
#include "core/portable_math.h"

namespace intaglio::contact {

struct Extent {
  double low, high;  // z, local frame, metres
};

// Exact; of a compound that of all its parts.
Extent extent_of(const Shape& shape, const Frame& frame);

// The body's lower side as a height over the surface: what §1.3.1 rasterises. Internal to contact/.

// Of one shape that is not a compound.
class LowerHeight {
 public:
  LowerHeight(const Shape& shape, const Frame& frame) : shape_(shape), frame_(frame) {}

  // z of the lowest point of the body over local (x, y), metres; infinite beside the body.
  double at(double x, double y) const;

 private:
  const Shape& shape_;
  const Frame& frame_;
};

// The points of a body that can touch a plane below it: what the flat and the normal map's methods ask.
// Internal to contact/.

struct Foot {
  Vec3 point;     // of the body, local frame
  Vec3 core;      // what a round body turns about there: the centre of its curvature
  double radius;  // of that curvature; 0 at a corner
  int index;      // which one of the part, the same while the body turns
};

// Calls visit(foot, child) for every point that is lowest among its neighbours, or nearly: corners of boxes,
// hulls and meshes, ends of capsules, of cylinders four points of each rim. Returns status bits.
template <class Visit>
unsigned for_each_foot(const Shape& shape, const Frame& frame, const Visit& visit);

namespace feet {

template <class Visit>
void of(const Sphere& s, const Frame& frame, const Visit& visit) {
  visit(Foot{frame.origin - s.radius * Vec3::UnitZ(), frame.origin, s.radius, 0});
}

template <class Visit>
void of(const Capsule& s, const Frame& frame, const Visit& visit) {
  for (const int end : {0, 1}) {
    const Vec3 centre = frame({0, end == 0 ? -s.half_height : s.half_height, 0});
    visit(Foot{centre - s.radius * Vec3::UnitZ(), centre, s.radius, end});
  }
}

template <class Visit>
void of(const Box& s, const Frame& frame, const Visit& visit) {
  for (int k = 0; k < 8; ++k) {
    const Vec3 point = frame(Vec3(k & 1 ? s.half.x() : -s.half.x(), k & 2 ? s.half.y() : -s.half.y(),
                                  k & 4 ? s.half.z() : -s.half.z()));
    visit(Foot{point, point, 0, k});
  }
}

// The lowest point of each rim and those a quarter and a half round from it: a standing cylinder rests on
// them.
template <class Visit>
void of(const Cylinder& s, const Frame& frame, const Visit& visit) {
  const Vec3 axis = frame.axes.col(1);
  Vec3 down = -Vec3::UnitZ() + axis.z() * axis;
  // Upright, none is lowest: those of the body's own axes.
  down = down.norm() > 1e-6 ? Vec3(down.normalized()) : Vec3(frame.axes.col(0));
  const Vec3 aside = axis.cross(down);
  for (int k = 0; k < 8; ++k) {
    const Vec3 out = (k & 2 ? aside : down) * (k & 4 ? -s.radius : s.radius);
    const Vec3 point = frame.origin + (k & 1 ? s.half_height : -s.half_height) * axis + out;
    visit(Foot{point, point, 0, k});
  }
}

template <class Visit>
void of(const std::shared_ptr<const Polyhedron>& form, const Frame& frame, const Visit& visit) {
  int index = 0;
  for (const Vec3& v : form->vertices) {
    const Vec3 point = frame(v);
    visit(Foot{point, point, 0, index++});
  }
}

template <class Visit>
void of(const ConvexHull& s, const Frame& frame, const Visit& visit) {
  of(s.form, frame, visit);
}
template <class Visit>
void of(const Mesh& s, const Frame& frame, const Visit& visit) {
  of(s.form, frame, visit);
}
template <class Visit>
void of(const Compound&, const Frame&, const Visit&) {}

}  // namespace feet

template <class Visit>
unsigned for_each_foot(const Shape& shape, const Frame& frame, const Visit& visit) {
  return for_each_part(shape, frame, [&](const Shape& part, const Frame& at, int child) {
    std::visit([&](const auto& s) { feet::of(s, at, [&](const Foot& foot) { visit(foot, child); }); }, part);
  });
}

// Convex bodies as the greatest of their faces' planes: negative inside, where it is the distance to the
// nearest face; outside no more than the distance. Internal to contact/.

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
