#include "contact/surface_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/body_extent.h"
#include "contact/contact_point.h"
#include "contact/pairs.h"
#include "contact/query.h"

namespace intaglio::contact {

namespace {

// Built at static initialisation, so that queries do not allocate.
const Polyhedron cube = make_cube();

struct PairsOf {
  const Asked& asked;
  const Frame& frame;

  void operator()(const Sphere& s) const { ball_pairs(asked, frame.origin, s.radius, 0); }
  void operator()(const Capsule& s) const {
    const Vec3 along = frame.axes.col(1), to = frame.origin + s.half_height * along,
               from = frame.origin - s.half_height * along;
    const Vec3 back = -along;
    corner_pairs(asked, from, std::span(&along, 1), s.radius, 0);
    corner_pairs(asked, to, std::span(&back, 1), s.radius, 1);
    edge_pairs(asked, {from, to, {}, s.radius, 0});
  }
  void operator()(const Box& s) const { polyhedron_pairs(asked, cube, s.half, frame); }
  void operator()(const Cylinder& s) const { cylinder_pairs(asked, s, frame); }
  void operator()(const ConvexHull& s) const { polyhedron_pairs(asked, *s.form, Vec3::Ones(), frame); }
  void operator()(const Mesh& s) const { polyhedron_pairs(asked, *s.form, Vec3::Ones(), frame); }
  void operator()(const Compound&) const {}
};

// The way out when there is no other: up, where a part's own origin is over or under the relief.
void push_up(const Question& question, const Shape& shape, Candidates& found, unsigned& status) {
  const surface::Surface& surface = question.surface;
  const Extent whole = extent_of(shape, question.frame);
  const double lowest = -surface.max_depth() * surface.pyramid().total_range().deep;
  for_each_part(shape, question.frame, [&](const Shape& part, const Frame& frame, int child) {
    const Vec3& at = frame.origin;
    if (!surface.placement().covers(at)) return;
    const double relief = -surface.depth(surface.placement().uv(at));
    if (!(LowerHeight(part, frame).at(at.x(), at.y()) < relief)) return;
    const Extent body = extent_of(part, frame);
    status |= whole.high < lowest ? status::under : status::deep;
    // Farther down it is not in the surface any more but elsewhere.
    if (relief - body.high > 2 * question.reach) return;
    found.add({Vec3(at.x(), at.y(), relief), Vec3::UnitZ(), body.low - relief,
               feature_id(0, 0, Where::patch, Part::round, 0, child)});
  });
}

}  // namespace

ContactSet relief_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                           double margin) {
  if (surface.is_flat()) return plane_contacts(surface, shape, pose, margin);
  ContactSet set;
  const Question question(surface, shape, pose, margin);
  set.status = question.wrong;
  if (question.hopeless) return set;
  Candidates found(question.margin);
  const double overlap = std::max(question.margin, std::max(surface.texel_u(), surface.texel_v()));
  set.status |= for_each_part(shape, question.frame, [&](const Shape& part, const Frame& frame, int child) {
    const Asked asked{surface, child, overlap, found};
    std::visit(PairsOf{asked, frame}, part);
  });
  if (found.use_spare()) set.status |= status::deep;
  if (found.size() == 0) push_up(question, shape, found, set.status);
  if (found.overflowed()) set.status |= status::limit;
  found.choose(surface, set);
  return set;
}

// The flat rectangle and the normal map on it.

namespace {

// Deeper than this below the plane is beneath it, not in it: a round foot by its radius, a corner by the
// whole body.
double deepest(const Foot& foot, double reach) {
  return foot.radius > 0 ? 2 * foot.radius : 2 * reach;
}

}  // namespace

ContactSet plane_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                          double margin) {
  ContactSet set;
  const Question question(surface, shape, pose, margin);
  set.status = question.wrong;
  if (question.hopeless) return set;
  Candidates found(question.margin);
  const surface::Placement& place = surface.placement();
  set.status |= for_each_foot(shape, question.frame, [&](const Foot& foot, int child) {
    const double gap = foot.point.z();
    if (!(gap <= question.margin) || gap < -deepest(foot, question.reach) || !place.covers(foot.point))
      return;
    const Vec3 on_plane(foot.point.x(), foot.point.y(), 0);
    found.add(
        {on_plane, Vec3::UnitZ(), gap, feature_id(0, 0, Where::patch, Part::vertex, foot.index, child)});
  });
  if (found.overflowed()) set.status |= status::limit;
  found.choose(surface, set);
  return set;
}

ContactSet normal_map_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                               double margin) {
  ContactSet set = plane_contacts(surface, shape, pose, margin);
  for (std::size_t k = 0; k < set.count; ++k) set.points[k].normal = set.points[k].n_s;
  // Of a ball the point moves along (Eq. 1.2); a corner stays where it is.
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    for (std::size_t k = 0; k < set.count; ++k)
      set.points[k].point = sphere_contact_point(pose.position, sphere->radius, set.points[k].n_s);
  }
  return set;
}

ContactSet flat_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                         double margin) {
  ContactSet set = plane_contacts(surface, shape, pose, margin);
  for (std::size_t k = 0; k < set.count; ++k) set.points[k].n_s = set.points[k].normal;
  return set;
}

ContactSet directional_contacts(const surface::Surface& surface, const Shape& shape, const Pose& pose,
                                double margin) {
  ContactSet set;
  const Question question(surface, shape, pose, margin);
  set.status = question.wrong;
  if (question.hopeless) return set;
  const surface::Placement& place = surface.placement();
  const Vec3& middle = question.frame.origin;
  const double r = question.reach;
  std::array<Candidate, 4> deepest;
  std::array<bool, 4> found{};
  const auto first = surface.cell_at(std::max(middle.x() - r, 0.0), std::max(middle.y() - r, 0.0));
  const auto last =
      surface.cell_at(std::min(middle.x() + r, place.size_u()), std::min(middle.y() + r, place.size_v()));
  set.status |= for_each_part(shape, question.frame, [&](const Shape& part, const Frame& frame, int child) {
    const LowerHeight lower(part, frame);
    for (int j = first.second; j <= last.second + 1; ++j) {
      for (int i = first.first; i <= last.first + 1; ++i) {
        const Vec3 texel((i + 0.5) * surface.texel_u(), (j + 0.5) * surface.texel_v(), surface.texel_z(i, j));
        if (!place.covers(texel)) continue;
        const double distance = lower.at(texel.x(), texel.y()) - texel.z();
        const auto quadrant =
            static_cast<std::size_t>((texel.x() > middle.x() ? 1 : 0) + (texel.y() > middle.y() ? 2 : 0));
        if (!(distance <= question.margin) || (found[quadrant] && distance >= deepest[quadrant].distance))
          continue;
        found[quadrant] = true;
        deepest[quadrant] = {texel, surface.normal(place.uv(texel)), distance,
                             feature_id(i, j, Where::corner, Part::round, 0, child)};
      }
    }
  });
  for (std::size_t q = 0; q < deepest.size(); ++q) {
    if (!found[q]) continue;
    const Candidate& c = deepest[q];
    const Vec3 n_s = place.direction_to_world(c.normal);
    set.points[set.count++] = {place.to_world(c.point), n_s, n_s, c.distance, place.uv(c.point), c.feature};
  }
  std::sort(set.points.begin(), set.points.begin() + static_cast<std::ptrdiff_t>(set.count),
            [](const ContactPoint& a, const ContactPoint& b) { return a.distance < b.distance; });
  return set;
}

}  // namespace intaglio::contact
