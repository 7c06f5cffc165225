#include "contact/surface_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "contact/body_extent.h"
#include "contact/cylinder_pairs.h"
#include "contact/face_pairs.h"
#include "contact/pairs.h"
#include "contact/query.h"

namespace intaglio::contact {

namespace {

// Built at static initialisation, so that queries do not allocate.
const Polyhedron cube = make_cube();

struct PairVisitor {
  const PairQuery& query;
  const Frame& frame;

  void operator()(const Sphere& s) const { sphere_pairs(query, frame.origin, s.radius, 0); }
  void operator()(const Capsule& s) const {
    const Vec3 along = frame.axes.col(1), to = frame.origin + s.half_height * along,
               from = frame.origin - s.half_height * along;
    const Vec3 back = -along;
    corner_pairs(query, from, std::span(&along, 1), s.radius, 0);
    corner_pairs(query, to, std::span(&back, 1), s.radius, 1);
    edge_pairs(query, {from, to, {}, s.radius, 0});
  }
  void operator()(const Box& s) const { polyhedron_pairs(query, cube, s.half, frame); }
  void operator()(const Cylinder& s) const { cylinder_pairs(query, s, frame); }
  void operator()(const ConvexHull& s) const { polyhedron_pairs(query, *s.form, Vec3::Ones(), frame); }
  void operator()(const Mesh& s) const { polyhedron_pairs(query, *s.form, Vec3::Ones(), frame); }
  void operator()(const Compound&) const {}
};

// When there is no pair at all: push up wherever the underside at a part's origin is below the relief.
void push_up(const QuerySetup& setup, const Shape& shape, Candidates& found, unsigned& status) {
  const surface::Surface& surface = setup.surface;
  const Extent whole = vertical_extent(shape, setup.frame);
  const double lowest = -surface.max_depth() * surface.pyramid().total_range().deep;
  for_each_part(shape, setup.frame, [&](const Shape& one, const Frame& frame, int part) {
    const Vec3& at = frame.origin;
    if (!surface.placement().covers(at)) return;
    const double relief = -surface.depth(surface.placement().uv(at));
    if (!(Underside(one, frame).at(at.x(), at.y()) < relief)) return;
    const Extent body = vertical_extent(one, frame);
    status |= whole.high < lowest ? status::under : status::deep;
    // More than a diameter below counts as out of reach.
    if (relief - body.high > 2 * setup.bounding_radius) return;
    found.add({Vec3(at.x(), at.y(), relief), Vec3::UnitZ(), body.low - relief,
               feature_id(0, 0, ReliefFeature::patch, BodyFeature::smooth, 0, part)});
  });
}

// Contacts with the rectangle z = 0, their normals n_g; n_s is that of the map.
ContactSet plane_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                          double margin) {
  ContactSet set;
  const QuerySetup setup(surface, shape, pose, margin);
  set.status = setup.status;
  if (setup.is_clear) return set;
  Candidates found(setup.margin);
  const surface::Placement& place = surface.placement();
  set.status |= for_each_support_point(shape, setup.frame, [&](const SupportPoint& support, int part) {
    const double gap = support.point.z();
    // Deeper than this a point counts as beneath the plane: for a corner twice the body's bounding radius.
    const double max_depth = 2 * (support.radius > 0 ? support.radius : setup.bounding_radius);
    if (!(gap <= setup.margin) || gap < -max_depth || !place.covers(support.point)) return;
    const Vec3 on_plane(support.point.x(), support.point.y(), 0);
    found.add({on_plane, Vec3::UnitZ(), gap,
               feature_id(0, 0, ReliefFeature::patch, BodyFeature::vertex, support.index, part)});
  });
  found.select(surface, set);
  return set;
}

}  // namespace

ContactSet relief_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                           double margin) {
  if (surface.is_flat()) return plane_contacts(surface, shape, pose, margin);
  ContactSet set;
  const QuerySetup setup(surface, shape, pose, margin);
  set.status = setup.status;
  if (setup.is_clear) return set;
  Candidates found(setup.margin);
  const double max_penetration = std::max(setup.margin, std::max(surface.texel_u(), surface.texel_v()));
  set.status |= for_each_part(shape, setup.frame, [&](const Shape& one, const Frame& frame, int part) {
    const PairQuery query{surface, part, max_penetration, found};
    std::visit(PairVisitor{query, frame}, one);
  });
  if (found.use_substitute()) set.status |= status::deep;
  if (found.size() == 0) push_up(setup, shape, found, set.status);
  found.select(surface, set);
  return set;
}

ContactSet flat_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                         double margin) {
  ContactSet set = plane_contacts(surface, shape, pose, margin);
  for (std::size_t k = 0; k < set.count; ++k) set.points[k].n_s = set.points[k].normal;
  return set;
}

ContactSet normal_map_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                               double margin) {
  ContactSet set = plane_contacts(surface, shape, pose, margin);
  for (std::size_t k = 0; k < set.count; ++k) set.points[k].normal = set.points[k].n_s;
  // For a sphere the contact point moves too (Eq. 1.2); a corner stays where it is.
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    for (std::size_t k = 0; k < set.count; ++k)
      set.points[k].point = sphere_contact_point(pose.position, sphere->radius, set.points[k].n_s);
  }
  return set;
}

ContactSet directional_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                                double margin) {
  ContactSet set;
  const QuerySetup setup(surface, shape, pose, margin);
  set.status = setup.status;
  if (setup.is_clear) return set;
  const surface::Placement& place = surface.placement();
  const Vec3& middle = setup.frame.origin;
  const double r = setup.bounding_radius;
  std::array<Candidate, 4> deepest;
  std::array<bool, 4> found{};
  const auto first = surface.cell_at(std::max(middle.x() - r, 0.0), std::max(middle.y() - r, 0.0));
  const auto last =
      surface.cell_at(std::min(middle.x() + r, place.size_u()), std::min(middle.y() + r, place.size_v()));
  set.status |= for_each_part(shape, setup.frame, [&](const Shape& one, const Frame& frame, int part) {
    const Underside underside(one, frame);
    for (int j = first.second; j <= last.second + 1; ++j) {
      for (int i = first.first; i <= last.first + 1; ++i) {
        const Vec3 texel((i + 0.5) * surface.texel_u(), (j + 0.5) * surface.texel_v(), surface.texel_z(i, j));
        if (!place.covers(texel)) continue;
        const double distance = underside.at(texel.x(), texel.y()) - texel.z();
        const auto quadrant =
            std::size_t((texel.x() > middle.x() ? 1 : 0) + (texel.y() > middle.y() ? 2 : 0));
        if (!(distance <= setup.margin) || (found[quadrant] && distance >= deepest[quadrant].distance))
          continue;
        found[quadrant] = true;
        deepest[quadrant] = {texel, surface.normal(place.uv(texel)), distance,
                             feature_id(i, j, ReliefFeature::corner, BodyFeature::smooth, 0, part)};
      }
    }
  });
  for (std::size_t q = 0; q < deepest.size(); ++q) {
    if (!found[q]) continue;
    const Candidate& c = deepest[q];
    const Vec3 n_s = place.direction_to_world(c.normal);
    set.points[set.count++] = {place.to_world(c.point), n_s, n_s, c.distance, place.uv(c.point), c.feature};
  }
  std::sort(set.points.begin(), set.points.begin() + std::ptrdiff_t(set.count),
            [](const ContactPoint& a, const ContactPoint& b) { return a.distance < b.distance; });
  return set;
}

}  // namespace intaglio::contact
