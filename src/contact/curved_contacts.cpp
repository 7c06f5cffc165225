#include "contact/curved_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

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

std::uint64_t internal::curved_feature_id(const surface::ReliefMesh& relief, int triangle,
                                          const Vec2& weights, BodyFeature body, int index, int part) {
  const surface::SurfacePlace place = surface::canonical_place(relief, triangle, weights);
  GridPlace grid{0, 0, false, false};
  if (!relief.surface().is_flat()) {
    const Vec2 cells = relief.triangle(place.triangle).cells(place.weights);
    grid = grid_place(cells[0], cells[1]);
  }
  return low_bits(place.triangle, triangle_bits) | low_bits(std::int64_t(grid.i), 12) << 22 |
         low_bits(std::int64_t(grid.j), 12) << 34 |
         low_bits((grid.on_column ? 1 : 0) + (grid.on_row ? 2 : 0), 2) << 46 | low_bits(body, 2) << 48 |
         low_bits(index, 8) << 50 | low_bits(part, 6) << 58;
}

void internal::select(const surface::ReliefMesh& relief, Candidates& found, ContactSet& set) {
  if (found.overflowed()) set.status |= status::limit;
  Candidates::Selected selected;
  const std::size_t count = found.select(selected);
  for (std::size_t k = 0; k < count; ++k) {
    const Candidate& c = *selected[k];
    ContactPoint out;
    out.point = c.point;
    out.normal = out.n_s = c.normal;
    out.distance = c.distance;
    out.feature = c.feature;
    const int triangle = int(low_bits(c.feature, triangle_bits));
    if (const auto base = relief.base_below(triangle, c.point)) {
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

struct CurvedQuery {
  const ReliefMesh& relief;
  int part;
  double max_penetration;
  Candidates& found;
  unsigned& status;

  void add(const MeshFeature& f, double radius, BodyFeature body, int index) const {
    if (f.distance < -max_penetration) {
      status |= status::under;
      return;
    }
    found.add({f.point, f.direction, f.distance - radius,
               internal::curved_feature_id(relief, f.triangle, f.weights, body, index, part)});
  }
};

void sphere(const CurvedQuery& query, const Vec3& centre, double radius, int index) {
  std::array<MeshFeature, ContactSet::capacity> features;
  const std::size_t count =
      closest_features(query.relief, centre, radius + query.found.max_distance(), min_angle, features);
  for (std::size_t k = 0; k < count; ++k) query.add(features[k], radius, BodyFeature::smooth, index);
  if (count > 0) return;
  // No feature nearby: the centre may be deep below the surface.
  const double reach = 2 * query.max_penetration;
  const auto base = query.relief.base().closest(centre, reach);
  if (!base || base->height > -query.relief.surface().depth(base->uv)) return;
  const auto nearest = closest_point(query.relief, centre, reach);
  if (nearest && nearest->distance < 0) query.add(*nearest, radius, BodyFeature::smooth, index);
}

void corner(const CurvedQuery& query, const Vec3& at, std::span<const Vec3> edges, int index) {
  const double max_distance = query.found.max_distance();
  const auto nearest = closest_point(query.relief, at, std::max(max_distance, 2 * query.max_penetration));
  if (!nearest || nearest->distance > max_distance) return;
  if (is_in_corner_cone(nearest->direction, edges)) query.add(*nearest, 0, BodyFeature::vertex, index);
}

// Finds the points of the relief that are inside a convex body or near its faces. Each piece of the relief
// gives at most one: its deepest point, among those where the relief faces the body face nearest to them.
template <class Body>
class InsideSearch {
 public:
  InsideSearch(const CurvedQuery& query, const Body& body) : query_(query), body_(body) {}

  double limit() const { return query_.found.search_limit(); }
  double lower_bound(const surface::Bounds& box) const {
    const NearestFace face = body_.nearest_face(box.center());
    return face.height - 0.5 * face.normal.cwiseAbs().dot(box.sizes());
  }
  double lower_bound(const surface::LinearPiece& piece) const {
    const NearestFace face = body_.nearest_face(piece.middle);
    return face.height + piece.min_along(face.normal) - piece.error;
  }
  void visit(const surface::ReliefPiece& piece) {
    best_.height = query_.found.search_limit();
    found_ = false;
    search(piece, 10);
    if (!found_) return;
    MeshFeature feature;
    feature.point = piece.point(at_);
    feature.direction = -best_.normal;
    feature.distance = best_.height;
    feature.triangle = piece.triangle.index;
    feature.weights = at_;
    query_.add(feature, 0, BodyFeature::face, best_.face);
  }

 private:
  struct Sample {
    NearestFace face;
    bool faces_it;  // whether the relief's outward side faces that body face
  };
  Sample evaluate(const surface::ReliefPiece& piece, const Vec2& at) {
    const NearestFace face = body_.nearest_face(piece.point(at));
    const bool faces_it = piece.base_normal(at).dot(face.normal) < 0;
    if (faces_it && face.height < best_.height) {
      best_ = face;
      at_ = at;
      found_ = true;
    }
    return {face, faces_it};
  }

  // With one nearest face the minimum is at a corner of the piece; where several compete the piece is halved.
  void search(const surface::ReliefPiece& piece, int subdivisions) {
    const Sample centre = evaluate(piece, piece.outline.centroid());
    bool any = centre.faces_it, has_seam = false;
    for (const Vec2& corner : piece.outline) {
      const Sample here = evaluate(piece, corner);
      any = any || here.faces_it;
      has_seam = has_seam || here.face.normal != centre.face.normal;
    }
    if (subdivisions == 0 || !any || !has_seam) return;
    const surface::LinearPiece linear = piece.linear();
    if (lower_bound(linear) >= best_.height - 1e-3 * query_.relief.texel_size()) return;
    piece.for_each_half(linear.longer_axis(),
                        [&](const surface::ReliefPiece& half) { search(half, subdivisions - 1); });
  }

  const CurvedQuery& query_;
  const Body& body_;
  NearestFace best_{Vec3::Zero(), 0, 0};
  Vec2 at_ = Vec2::Zero();
  bool found_ = false;
};

template <class Body>
void faces(const CurvedQuery& query, const Body& body) {
  InsideSearch<Body> search(query, body);
  query.relief.visit_pieces(search);
}

struct CurvedVisitor {
  const CurvedQuery& query;
  const Frame& frame;

  void operator()(const Sphere& s) const { sphere(query, frame.origin, s.radius, 0); }
  void operator()(const Capsule& s) const {
    const Vec3 along = s.half_height * frame.axes.col(1), from = frame.origin - along,
               to = frame.origin + along;
    sphere(query, from, s.radius, 0);
    sphere(query, to, s.radius, 1);
    const double reach = s.radius + query.found.max_distance();
    if (const auto f = closest_to_segment(query.relief, from, to, reach))
      query.add(*f, s.radius, BodyFeature::edge, 0);
  }
  void operator()(const Box& s) const {
    for (int k = 0; k < 8; ++k) {
      const Vec3 sign = box_corner(Vec3::Ones(), k);
      std::array<Vec3, 3> edges;
      for (int axis = 0; axis < 3; ++axis) edges[std::size_t(axis)] = -sign[axis] * frame.axes.col(axis);
      corner(query, frame(box_corner(s.half, k)), edges, k);
    }
    faces(query, BoxFaces{frame, s.half});
  }
  void operator()(const Cylinder& s) const {
    constexpr int corners = 16;
    for (int k = 0; k < 2 * corners; ++k) {
      const double angle = k * 2 * std::numbers::pi / corners, end = k < corners ? -1 : 1;
      const Vec3 out(elementary::cos(angle), 0, elementary::sin(angle));
      const std::array<Vec3, 2> edges = {frame.axes * -out, -end * frame.axes.col(1)};
      corner(query, frame(s.radius * out + end * s.half_height * Vec3::UnitY()), edges, k);
    }
    faces(query, CylinderFaces{frame, s.radius, s.half_height});
  }
  void operator()(const ConvexHull& s) const {
    corners_of(*s.form);
    faces(query, HullFaces{frame, *s.form});
  }
  void operator()(const Mesh& s) const { corners_of(*s.form); }
  void operator()(const Compound&) const {}

  void corners_of(const Polyhedron& form) const {
    const auto vertex_at = [&](int k) { return frame(form.vertices[std::size_t(k)]); };
    for (std::size_t k = 0; k < form.vertices.size(); ++k) {
      std::array<Vec3, max_edges_of_vertex> directions;
      corner(query, vertex_at(int(k)), edge_directions(form, k, vertex_at, directions), int(k));
    }
  }
};

// Whether a body is deep in the solid, with nothing of the relief in its own box.
bool is_under(const ReliefMesh& relief, const Vec3& at, double reach) {
  if (!relief.bounds().contains(at)) return false;
  const Vec3 half = Vec3::Constant(reach);
  bool is_near = false;
  relief.for_each_triangle({at - half, at + half}, [&](int) { is_near = true; });
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
  const double radius = has_size(shape) ? bounding_radius(shape) : 0;
  if (!(radius > 0) || !std::isfinite(radius)) {
    set.status = status::no_size;
    return set;
  }
  const surface::Bounds bounds = relief.bounds();
  const double side = bounds.sizes().maxCoeff();
  set.status |= limit_margin(margin, side);
  if (is_far(pose.position - bounds.center(), side)) {
    set.status |= status::far;
    return set;
  }
  if (bounds.exteriorDistance(pose.position) > radius + margin) return set;
  Candidates found(margin);
  const Frame frame{pose.orientation.normalized().toRotationMatrix(), pose.position};
  set.status |= for_each_part(shape, frame, [&](const Shape& one, const Frame& at, int part) {
    const CurvedQuery query{relief, part, 2 * radius + margin, found, set.status};
    std::visit(CurvedVisitor{query, at}, one);
  });
  if (found.overflowed()) set.status |= status::limit;
  if (found.size() == 0 && set.status == status::ok && is_under(relief, pose.position, radius + margin))
    set.status |= status::under;
  internal::select(relief, found, set);
  return set;
}

}  // namespace intaglio::contact
