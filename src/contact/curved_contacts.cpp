#include "contact/curved_contacts.h"

#include <algorithm>
#include <cmath>

#include "contact/body_extent.h"
#include "contact/pairs.h"
#include "contact/query.h"
#include "core/portable_math.h"
#include "mesh/relief_closest.h"

namespace intaglio::contact {

namespace {

constexpr unsigned triangle_bits = 22;
static_assert(surface::max_mesh_triangles <= (std::size_t{1} << triangle_bits));

}  // namespace

std::uint64_t curved_feature_id(const surface::ReliefMesh& relief, int triangle, const Vec2& weights,
                                Part part, int index, int child) {
  constexpr double near = 1e-6;
  const auto bits = [](auto value, unsigned count) {
    return static_cast<std::uint64_t>(value) & ((std::uint64_t{1} << count) - 1);
  };
  const surface::MeshPlace place = surface::first_of(relief, triangle, weights);
  Vec2 first = Vec2::Zero(), on_line = Vec2::Zero();
  if (!relief.surface().is_flat()) {
    const Vec2 cells = relief.triangle(place.triangle).cells(place.weights);
    for (int axis = 0; axis < 2; ++axis) {
      first[axis] = std::floor(cells[axis] + near);
      on_line[axis] = cells[axis] - first[axis] < near ? 1 : 0;
    }
  }
  return bits(place.triangle, triangle_bits) | bits(static_cast<std::int64_t>(first[0]), 12) << 22 |
         bits(static_cast<std::int64_t>(first[1]), 12) << 34 |
         bits(static_cast<int>(on_line[0] + 2 * on_line[1]), 2) << 46 | bits(part, 2) << 48 |
         bits(index, 8) << 50 | bits(child, 6) << 58;
}

void report(const surface::ReliefMesh& relief, Candidates& found, ContactSet& set) {
  Candidates::Chosen chosen;
  const std::size_t count = found.choose(chosen);
  for (std::size_t k = 0; k < count; ++k) {
    const Candidate& c = *chosen[k];
    ContactPoint out;
    out.point = c.point;
    out.normal = out.n_s = c.normal;
    out.distance = c.distance;
    out.feature = c.feature;
    const int triangle = static_cast<int>(c.feature & ((std::uint64_t{1} << triangle_bits) - 1));
    if (const auto base = relief.under(triangle, c.point)) {
      out.uv = base->uv;
      out.triangle = triangle;
      out.weights = base->weights;
      out.n_s = base->direction_to_world(relief.surface().normal(base->uv));
    }
    set.points[set.count++] = out;
  }
}

namespace {

using surface::MeshFeature;
using surface::ReliefMesh;

struct CurvedAsked {
  const ReliefMesh& relief;
  int child;
  double deepest;  // what is below by more is elsewhere
  Candidates& found;
  unsigned& status;

  void add(const MeshFeature& f, double radius, Part part, int index) const {
    if (f.distance < -deepest) {
      status |= status::under;
      return;
    }
    found.add({f.point, f.direction, f.distance - radius,
               curved_feature_id(relief, f.triangle, f.weights, part, index, child)});
  }
};

void ball(const CurvedAsked& asked, const Vec3& centre, double radius, int index) {
  std::array<MeshFeature, ContactSet::capacity> features;
  const std::size_t count =
      closest_features(asked.relief, centre, radius + asked.found.limit(), min_angle, features);
  for (std::size_t k = 0; k < count; ++k) asked.add(features[k], radius, Part::round, index);
  if (count > 0) return;
  // Nothing near may also mean: deep below.
  const double reach = 2 * asked.deepest;
  const auto base = asked.relief.base().closest(centre, reach);
  if (!base || base->height > -asked.relief.surface().depth(base->uv)) return;
  const auto nearest = closest_point(asked.relief, centre, reach);
  if (nearest && nearest->distance < 0) asked.add(*nearest, radius, Part::round, index);
}

void corner(const CurvedAsked& asked, const Vec3& at, std::span<const Vec3> around, int index) {
  const auto nearest = closest_point(asked.relief, at, std::max(asked.found.limit(), 2 * asked.deepest));
  if (!nearest || nearest->distance > asked.found.limit()) return;
  // The relief's normal must be among the corner's own.
  const bool is_least = std::all_of(around.begin(), around.end(), [&](const Vec3& edge) {
    return nearest->direction.dot(edge) >= -corner_slack;
  });
  if (is_least) asked.add(*nearest, 0, Part::vertex, index);
}

// The relief inside of a convex body or near its faces: of each piece the point that is deepest in, of those
// whose outer side looks at the face that is nearest.
template <class Body>
class InsideSearch {
 public:
  InsideSearch(const CurvedAsked& asked, const Body& body) : asked_(asked), body_(body) {}

  double limit() const { return asked_.found.limit() + 1e-300; }
  double least(const surface::Box& box) const {
    const SupportingPlane plane = body_.plane_at(box.center());
    return plane.height - 0.5 * plane.normal.cwiseAbs().dot(box.sizes());
  }
  double least(const surface::FlatPiece& piece) const {
    const SupportingPlane plane = body_.plane_at(piece.middle);
    return plane.height + piece.least_along(plane.normal) - piece.play;
  }
  void visit(const surface::ReliefPiece& piece) {
    best_.height = asked_.found.limit() + 1e-300;
    found_ = false;
    search(piece, 10);
    if (!found_) return;
    MeshFeature feature;
    feature.point = piece.point(at_);
    feature.direction = -best_.normal;
    feature.distance = best_.height;
    feature.triangle = piece.triangle.index;
    feature.weights = at_;
    asked_.add(feature, 0, Part::face, best_.face);
  }

 private:
  // The face that a place is nearest to, and whether the relief's outer side looks at it there.
  struct Look {
    SupportingPlane plane;
    bool faces;
  };
  Look look(const surface::ReliefPiece& piece, const Vec2& at) {
    const SupportingPlane plane = body_.plane_at(piece.point(at));
    const bool faces = piece.base_normal(at).dot(plane.normal) < 0;
    if (faces && plane.height < best_.height) {
      best_ = plane;
      at_ = at;
      found_ = true;
    }
    return {plane, faces};
  }

  // Where one face is nearest, the lowest place is a corner; along the seams of faces the piece is cut.
  void search(const surface::ReliefPiece& piece, int cuts) {
    const Vec2 middle = piece.outline.middle();
    const Look centre = look(piece, middle);
    bool any = centre.faces, seam = false;
    for (const Vec2& corner : piece.outline) {
      const Look here = look(piece, corner);
      any = any || here.faces;
      seam = seam || here.plane.normal != centre.plane.normal;
    }
    if (cuts == 0 || !any || !seam) return;
    const surface::FlatPiece flat(piece.triangle, piece.outline, piece.heights(middle), middle);
    if (least(flat) >= best_.height - 1e-3 * asked_.relief.texel()) return;
    surface::WeightPolygon below, above;
    const Vec2 across = flat.longer_way();
    piece.outline.split(across, -across.dot(middle), below, above);
    for (const surface::WeightPolygon* half : {&below, &above}) {
      if (half->is_empty()) continue;
      surface::ReliefPiece part = piece;
      part.outline = *half;
      search(part, cuts - 1);
    }
  }

  const CurvedAsked& asked_;
  const Body& body_;
  SupportingPlane best_{Vec3::Zero(), 0, 0};
  Vec2 at_ = Vec2::Zero();
  bool found_ = false;
};

template <class Body>
void faces(const CurvedAsked& asked, const Body& body) {
  InsideSearch<Body> search(asked, body);
  asked.relief.walk(search);
}

struct TouchOf {
  const CurvedAsked& asked;
  const Frame& frame;

  void operator()(const Sphere& s) const { ball(asked, frame.origin, s.radius, 0); }
  void operator()(const Capsule& s) const {
    const Vec3 along = s.half_height * frame.axes.col(1), from = frame.origin - along,
               to = frame.origin + along;
    ball(asked, from, s.radius, 0);
    ball(asked, to, s.radius, 1);
    const double reach = s.radius + asked.found.limit();
    if (const auto f = closest_to_segment(asked.relief, from, to, reach))
      asked.add(*f, s.radius, Part::edge, 0);
  }
  void operator()(const Box& s) const {
    for (int k = 0; k < 8; ++k) {
      const Vec3 sign(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      std::array<Vec3, 3> around;
      for (int axis = 0; axis < 3; ++axis)
        around[static_cast<std::size_t>(axis)] = -sign[axis] * frame.axes.col(axis);
      corner(asked, frame(sign.cwiseProduct(s.half)), around, k);
    }
    faces(asked, BoxPlanes{frame, s.half});
  }
  void operator()(const Cylinder& s) const {
    constexpr int corners = 16;
    for (int k = 0; k < 2 * corners; ++k) {
      const double angle = k * 2 * std::numbers::pi / corners, end = k < corners ? -1 : 1;
      const Vec3 out(elementary::cos(angle), 0, elementary::sin(angle));
      const std::array<Vec3, 2> around = {frame.axes * -out, -end * frame.axes.col(1)};
      corner(asked, frame(s.radius * out + end * s.half_height * Vec3::UnitY()), around, k);
    }
    faces(asked, CylinderPlanes{frame, s.radius, s.half_height});
  }
  void operator()(const ConvexHull& s) const {
    corners_of(*s.form);
    faces(asked, HullPlanes{frame, *s.form});
  }
  void operator()(const Mesh& s) const { corners_of(*s.form); }
  void operator()(const Compound&) const {}

  void corners_of(const Polyhedron& form) const {
    constexpr std::size_t most_around = 64;
    for (std::size_t k = 0; k < form.vertices.size(); ++k) {
      std::array<Vec3, most_around> around;
      std::size_t count = 0;
      const Vec3 at = frame(form.vertices[k]);
      for (auto n = static_cast<std::size_t>(form.first_neighbour[k]);
           n < static_cast<std::size_t>(form.first_neighbour[k + 1]) && count < most_around; ++n) {
        const auto neighbour = static_cast<std::size_t>(form.neighbours[n]);
        around[count++] = (frame(form.vertices[neighbour]) - at).normalized();
      }
      corner(asked, at, std::span(around).first(count), static_cast<int>(k));
    }
  }
};

// Whether a body is deep in the solid, with nothing of the relief in its own box.
bool is_under(const ReliefMesh& relief, const Vec3& at, double reach) {
  if (!relief.bounds().contains(at)) return false;
  const Vec3 aside = Vec3::Constant(reach);
  bool is_near = false;
  relief.for_each_triangle({at - aside, at + aside}, [&](int) { is_near = true; });
  if (is_near) return false;
  const auto nearest = closest_point(relief, at, relief.bounds().diagonal().norm());
  return nearest && nearest->distance < 0;
}

}  // namespace

ContactSet curved_contacts(const ReliefMesh& relief, const Shape& shape, const Pose& pose, double margin) {
  ContactSet set;
  if (!is_rigid(pose)) {
    set.status = status::bad_pose;
    return set;
  }
  const double reach = has_size(shape) ? bounding_radius(shape) : 0;
  if (!(reach > 0) || !std::isfinite(reach)) {
    set.status = status::no_size;
    return set;
  }
  const surface::Box bounds = relief.bounds();
  const double side = bounds.sizes().maxCoeff();
  if (!(margin <= side)) set.status |= status::wide_margin;
  margin = margin > 0 ? std::min(margin, side) : 0;
  if ((pose.position - bounds.center()).norm() > 1e5 * side) {
    set.status |= status::far;
    return set;
  }
  if (bounds.exteriorDistance(pose.position) > reach + margin) return set;
  Candidates found(margin);
  const Frame frame{pose.orientation.normalized().toRotationMatrix(), pose.position};
  set.status |= for_each_part(shape, frame, [&](const Shape& part, const Frame& at, int child) {
    const CurvedAsked asked{relief, child, 2 * reach + margin, found, set.status};
    std::visit(TouchOf{asked, at}, part);
  });
  if (found.overflowed()) set.status |= status::limit;
  if (found.size() == 0 && set.status == status::ok && is_under(relief, pose.position, reach + margin))
    set.status |= status::under;
  report(relief, found, set);
  return set;
}

}  // namespace intaglio::contact
