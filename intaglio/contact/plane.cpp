// The flat rectangle and the normal map on it.
#include "intaglio/contact/plane.h"

#include "intaglio/contact/collision_point.h"
#include "intaglio/contact/feet.h"

namespace intaglio::contact {

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

}  // namespace intaglio::contact
