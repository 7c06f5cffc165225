// Where a body ends: its vertical extent, its underside as a height, the points that can touch a plane, and
// the face nearest to a point. Local frame of a placement, metres; no allocation. Internal to contact/.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "contact/query.h"
#include "core/portable_math.h"

namespace intaglio::contact {

struct Extent {
  double low, high;  // z
};

// Exact. A compound's extent covers all parts.
Extent vertical_extent(const Shape& shape, const Frame& frame);

// A body's underside as a height over the plane, as rasterised in §1.3.1. Not for compounds.
class Underside {
 public:
  Underside(const Shape& shape, const Frame& frame) : shape_(shape), frame_(frame) {}

  // z of the lowest point of the body over (x, y); infinity where the vertical line misses the body.
  double at(double x, double y) const;

 private:
  const Shape& shape_;
  const Frame& frame_;
};

// Support points: the points of a body that can touch a horizontal plane; used by flat and normal-map
// contacts.
struct SupportPoint {
  Vec3 point;
  double radius;  // of the body's curvature there; 0 at a corner
  int index;      // within the part, independent of pose
};

namespace internal {

template <class Visit>
void visit_support(const Sphere& s, const Frame& frame, const Visit& visit) {
  visit(SupportPoint{frame.origin - s.radius * Vec3::UnitZ(), s.radius, 0});
}

template <class Visit>
void visit_support(const Capsule& s, const Frame& frame, const Visit& visit) {
  for (const int end : {0, 1}) {
    const Vec3 centre = frame({0, end == 0 ? -s.half_height : s.half_height, 0});
    visit(SupportPoint{centre - s.radius * Vec3::UnitZ(), s.radius, end});
  }
}

template <class Visit>
void visit_support(const Box& s, const Frame& frame, const Visit& visit) {
  for (int k = 0; k < 8; ++k) visit(SupportPoint{frame(box_corner(s.half, k)), 0, k});
}

// The lowest point of each rim and those at 90 and 180 degrees from it: a standing cylinder rests on them.
template <class Visit>
void visit_support(const Cylinder& s, const Frame& frame, const Visit& visit) {
  const Vec3 axis = frame.axes.col(1);
  Vec3 down = -Vec3::UnitZ() + axis.z() * axis;
  // Upright, all rim points are equally low: use the body's own axes.
  down = down.norm() > 1e-6 ? Vec3(down.normalized()) : Vec3(frame.axes.col(0));
  const Vec3 sideways = axis.cross(down);
  for (int k = 0; k < 8; ++k) {
    const Vec3 out = (k & 2 ? sideways : down) * (k & 4 ? -s.radius : s.radius);
    const Vec3 point = frame.origin + (k & 1 ? s.half_height : -s.half_height) * axis + out;
    visit(SupportPoint{point, 0, k});
  }
}

template <class Visit>
void visit_support(const Polyhedron& form, const Frame& frame, const Visit& visit) {
  int index = 0;
  for (const Vec3& v : form.vertices) visit(SupportPoint{frame(v), 0, index++});
}
template <class Visit>
void visit_support(const ConvexHull& s, const Frame& frame, const Visit& visit) {
  visit_support(*s.form, frame, visit);
}
template <class Visit>
void visit_support(const Mesh& s, const Frame& frame, const Visit& visit) {
  visit_support(*s.form, frame, visit);
}
template <class Visit>
void visit_support(const Compound&, const Frame&, const Visit&) {}

}  // namespace internal

// Calls visit(support point, part) for every point that is lowest among its neighbours, or nearly: corners of
// boxes, hulls and meshes, ends of capsules, four points of each rim of a cylinder. Returns status bits.
template <class Visit>
unsigned for_each_support_point(const Shape& shape, const Frame& frame, const Visit& visit) {
  return for_each_part(shape, frame, [&](const Shape& one, const Frame& at, int part) {
    std::visit(
        [&](const auto& s) {
          internal::visit_support(s, at, [&](const SupportPoint& point) { visit(point, part); });
        },
        one);
  });
}

// A convex body as the maximum over its face planes: negative inside, minus the distance to the nearest face;
// outside a lower bound of the distance.

// The face whose plane the point is highest above. Its plane is a lower bound of that maximum everywhere.
struct NearestFace {
  Vec3 normal;    // unit, outwards
  double height;  // of the point
  int face;
};

struct BoxFaces {
  const Frame& frame;
  Vec3 half;

  NearestFace nearest_face(const Vec3& x) const {
    const Vec3 local = frame.back(x);
    Eigen::Index axis = 0;
    const double height = (local.cwiseAbs() - half).maxCoeff(&axis);
    const double sign = local[axis] < 0 ? -1 : 1;
    return {sign * frame.axes.col(axis), height, int(2 * axis + (sign > 0 ? 1 : 0))};
  }
};

struct CylinderFaces {
  const Frame& frame;
  double radius, half_height;

  NearestFace nearest_face(const Vec3& x) const {
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

struct HullFaces {
  const Frame& frame;
  const Polyhedron& form;

  NearestFace nearest_face(const Vec3& x) const {
    const Vec3 local = frame.back(x);
    NearestFace out{Vec3::UnitY(), -1e300, 0};
    for (std::size_t k = 0; k < form.faces.size(); ++k) {
      const double height = form.faces[k].normal.dot(local) - form.faces[k].offset;
      if (height > out.height) out = {form.faces[k].normal, height, int(k)};
    }
    out.normal = frame.axes * out.normal;
    return out;
  }
};

// Unit directions of the edges of a polyhedron that leave a vertex, given where its vertices are. At most as
// many as fit `out`; further ones are ignored, which makes the vertex's cone of normals a little too wide.
inline constexpr std::size_t max_edges_of_vertex = 64;
template <class VertexAt>
std::span<const Vec3> edge_directions(const Polyhedron& form, std::size_t vertex, const VertexAt& vertex_at,
                                      std::array<Vec3, max_edges_of_vertex>& out) {
  const Vec3 from = vertex_at(int(vertex));
  std::size_t count = 0;
  const auto first = std::size_t(form.first_neighbour[vertex]),
             end = std::size_t(form.first_neighbour[vertex + 1]);
  for (std::size_t k = first; k < end && count < out.size(); ++k)
    out[count++] = (vertex_at(form.neighbours[k]) - from).normalized();
  return std::span(out).first(count);
}

}  // namespace intaglio::contact
