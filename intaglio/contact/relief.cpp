#include "intaglio/contact/relief.h"

#include <algorithm>

#include "intaglio/contact/extent_of.h"
#include "intaglio/contact/lower_height.h"
#include "intaglio/contact/pairs.h"
#include "intaglio/contact/plane.h"
#include "intaglio/contact/question.h"

namespace intaglio::contact {

namespace {

// Two units a side, made before main so that no query allocates.
const Polyhedron cube = [] {
  std::array<Vec3, 8> corners;
  for (int k = 0; k < 8; ++k) corners[std::size_t(k)] = Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  return **convex_hull(corners);
}();

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
  const double lowest = -surface.max_depth() * surface.pyramid().whole().deep;
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

}  // namespace intaglio::contact
