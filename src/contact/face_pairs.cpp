#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/face_pairs.h"
#include "contact/leaf_walk.h"
#include "contact/pairs.h"

namespace intaglio::contact {

namespace {

// More edges than this at one corner: the others are not asked about its cone of normals.
constexpr std::size_t most_around = 64;

// A polyhedron where it is now.
class Placed {
 public:
  Placed(const Polyhedron& polyhedron, const Vec3& scale, const Frame& frame)
      : form(polyhedron), scale_(scale), frame_(frame) {}

  Vec3 vertex(int k) const { return frame_(form.vertices[std::size_t(k)].cwiseProduct(scale_)); }
  // Scaling is along the axes, and only of what has its faces there: normals stay.
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
  FaceSearch(const Asked& asked, const Placed& body, int index, double top)
      : asked_(asked), body_(body), face_(body.form.faces[std::size_t(index)]), index_(index) {
    normal_ = body.normal(index);
    if (!(normal_.z() < 0)) return;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (int k = 0; k < face_.count; ++k) {
      const Vec3 v = body.vertex(body.corner(face_, k));
      if (k == 0) offset_ = normal_.dot(v);
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    if (low.z() > top + asked.found.limit()) return;
    side_pairs(
        asked, {normal_, offset_, low.head<2>(), high.head<2>(), index},
        [this](const Vec3& q, double distance, const auto& rests) { return counts(q, distance, rests); });
  }

 private:
  template <class Rests>
  bool counts(const Vec3& q, double distance, const Rests& rests) const {
    if (distance < 0 && body_.form.convex) return is_nearest(q, distance, rests);
    return distance >= -asked_.overlap && is_under(q, distance);
  }

  // Whether a point inside is nearer to no other face that could rest on it, and not much nearer to any.
  template <class Rests>
  bool is_nearest(const Vec3& q, double distance, const Rests& rests) const {
    for (int f = 0; f < int(body_.form.faces.size()); ++f) {
      if (f == index_) continue;
      const Vec3 n = body_.normal(f);
      const double other = n.dot(q - body_.vertex(body_.corner(body_.form.faces[std::size_t(f)], 0)));
      if (other > 0 || (n.z() < 0 && other > distance && (2 * other > distance || rests(n)))) return false;
    }
    return true;
  }
  // Whether its foot on the plane is in the face.
  bool is_under(const Vec3& q, double distance) const {
    const Vec3 foot = q - distance * normal_;
    Vec3 from = body_.vertex(body_.corner(face_, 0));
    for (int k = 0; k < face_.count; ++k) {
      const Vec3 to = body_.vertex(body_.corner(face_, k + 1));
      if ((to - from).cross(foot - from).dot(normal_) < 0) return false;
      from = to;
    }
    return true;
  }

  const Asked& asked_;
  const Placed& body_;
  const Polyhedron::Face& face_;
  int index_;
  Vec3 normal_;
  double offset_ = 0;
};

void corner(const Asked& asked, const Placed& body, int index, double top) {
  const Vec3 at = body.vertex(index);
  if (at.z() > top + asked.found.limit()) return;
  std::array<Vec3, most_around> around;
  std::size_t count = 0;
  const auto first = std::size_t(body.form.first_neighbour[std::size_t(index)]),
             end = std::size_t(body.form.first_neighbour[std::size_t(index) + 1]);
  for (std::size_t k = first; k < end && count < most_around; ++k)
    around[count++] = (body.vertex(body.form.neighbours[k]) - at).normalized();
  corner_pairs(asked, at, std::span(around).first(count), 0, index);
}

void edge(const Asked& asked, const Placed& body, int index, double top) {
  const Polyhedron::Edge& e = body.form.edges[std::size_t(index)];
  const Vec3 a = body.vertex(e.a), b = body.vertex(e.b);
  if (std::min(a.z(), b.z()) > top + asked.found.limit()) return;
  const Vec3 left = body.normal(e.left), right = body.normal(e.right);
  if (left.z() >= 0 && right.z() >= 0) return;  // no normal of the relief points at it
  const Vec3 along = (b - a).normalized();
  const std::array<Vec3, 2> inward = {left.cross(along), along.cross(right)};
  edge_pairs(asked, {a, b, inward, 0, index});
}

}  // namespace

void polyhedron_pairs(const Asked& asked, const Polyhedron& form, const Vec3& scale, const Frame& frame) {
  const Placed body(form, scale, frame);
  const double wide = form.radius * scale.maxCoeff() + std::max(asked.found.limit(), asked.overlap);
  const Vec2 at = frame.origin.head<2>(), aside = Vec2::Constant(wide);
  const double top = range_over(asked.surface, at - aside, at + aside).high;
  for (int k = 0; k < int(form.vertices.size()); ++k) corner(asked, body, k, top);
  for (int k = 0; k < int(form.faces.size()); ++k) FaceSearch(asked, body, k, top);
  for (int k = 0; k < int(form.edges.size()); ++k) edge(asked, body, k, top);
}

}  // namespace intaglio::contact
