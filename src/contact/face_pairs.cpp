#include "contact/face_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contact/body_extent.h"

namespace intaglio::contact {

namespace {

// A polyhedron at a pose.
class PosedPolyhedron {
 public:
  PosedPolyhedron(const Polyhedron& polyhedron, const Vec3& scale, const Frame& frame)
      : form(polyhedron), scale_(scale), frame_(frame) {}

  Vec3 vertex(int k) const { return frame_(form.vertices[std::size_t(k)].cwiseProduct(scale_)); }
  // Only a box is scaled, along its own axes, so normals do not change.
  Vec3 normal(int face) const { return frame_.axes * form.faces[std::size_t(face)].normal; }
  int corner(const Polyhedron::Face& face, int k) const {
    return form.loop[std::size_t(face.first + (k < face.count ? k : 0))];
  }

  const Polyhedron& form;

 private:
  const Vec3& scale_;
  const Frame& frame_;
};

// One face against the corners of the relief.
class FaceSearch {
 public:
  FaceSearch(const PairQuery& query, const PosedPolyhedron& body, int index)
      : query_(query), body_(body), face_(body.form.faces[std::size_t(index)]), index_(index) {
    normal_ = body.normal(index);
  }

  // `top`: the highest that the relief is near the body.
  void run(double top) const {
    if (!(normal_.z() < 0)) return;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (int k = 0; k < face_.count; ++k) {
      const Vec3 v = body_.vertex(body_.corner(face_, k));
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    if (low.z() > top + query_.found.max_distance()) return;
    const double offset = normal_.dot(body_.vertex(body_.corner(face_, 0)));
    flat_face_pairs(query_, {normal_, offset, low.head<2>(), high.head<2>(), index_},
                    [this](const Vec3& q, double distance, const auto& can_rest) {
                      return counts(q, distance, can_rest);
                    });
  }

 private:
  template <class CanRest>
  bool counts(const Vec3& q, double distance, const CanRest& can_rest) const {
    if (distance < 0 && body_.form.convex) return is_nearest(q, distance, can_rest);
    return distance >= -query_.max_penetration && is_over_face(q, distance);
  }

  // For a point inside the body: whether no other face that could rest on it is nearer, and no downward face
  // is less than half as far.
  template <class CanRest>
  bool is_nearest(const Vec3& q, double distance, const CanRest& can_rest) const {
    for (int f = 0; f < int(body_.form.faces.size()); ++f) {
      if (f == index_) continue;
      const Vec3 n = body_.normal(f);
      const double other = n.dot(q - body_.vertex(body_.corner(body_.form.faces[std::size_t(f)], 0)));
      if (other > 0 || (n.z() < 0 && other > distance && (2 * other > distance || can_rest(n)))) return false;
    }
    return true;
  }
  // Whether the foot of the point on the plane is in the face.
  bool is_over_face(const Vec3& q, double distance) const {
    const Vec3 foot = q - distance * normal_;
    Vec3 from = body_.vertex(body_.corner(face_, 0));
    for (int k = 0; k < face_.count; ++k) {
      const Vec3 to = body_.vertex(body_.corner(face_, k + 1));
      if ((to - from).cross(foot - from).dot(normal_) < 0) return false;
      from = to;
    }
    return true;
  }

  const PairQuery& query_;
  const PosedPolyhedron& body_;
  const Polyhedron::Face& face_;
  int index_;
  Vec3 normal_;
};

void corner(const PairQuery& query, const PosedPolyhedron& body, int index, double top) {
  const Vec3 at = body.vertex(index);
  if (at.z() > top + query.found.max_distance()) return;
  std::array<Vec3, max_edges_of_vertex> directions;
  const auto edges = edge_directions(
      body.form, std::size_t(index), [&](int k) { return body.vertex(k); }, directions);
  corner_pairs(query, at, edges, 0, index);
}

void edge(const PairQuery& query, const PosedPolyhedron& body, int index, double top) {
  const Polyhedron::Edge& e = body.form.edges[std::size_t(index)];
  const Vec3 a = body.vertex(e.a), b = body.vertex(e.b);
  if (std::min(a.z(), b.z()) > top + query.found.max_distance()) return;
  const Vec3 left = body.normal(e.left), right = body.normal(e.right);
  if (left.z() >= 0 && right.z() >= 0) return;  // both faces look up: the relief cannot touch it
  const Vec3 along = (b - a).normalized();
  const std::array<Vec3, 2> inward = {left.cross(along), along.cross(right)};
  edge_pairs(query, {a, b, inward, 0, index});
}

}  // namespace

void polyhedron_pairs(const PairQuery& query, const Polyhedron& form, const Vec3& scale, const Frame& frame) {
  const PosedPolyhedron body(form, scale, frame);
  const double reach =
      form.radius * scale.maxCoeff() + std::max(query.found.max_distance(), query.max_penetration);
  const double top = range_around(query.surface, frame.origin.head<2>(), reach).high;
  for (int k = 0; k < int(form.vertices.size()); ++k) corner(query, body, k, top);
  for (int k = 0; k < int(form.faces.size()); ++k) FaceSearch(query, body, k).run(top);
  for (int k = 0; k < int(form.edges.size()); ++k) edge(query, body, k, top);
}

}  // namespace intaglio::contact
