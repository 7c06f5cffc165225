#include <cmath>

#include "intaglio/contact/pairs.h"
#include "intaglio/contact/slack.h"
#include "intaglio/surface/closest.h"

namespace intaglio::contact {

namespace {

using surface::Feature;

void add_all(const Asked& asked, std::span<const Feature> features, std::span<const Vec3> around,
             double radius, Part part, int index) {
  for (const Feature& f : features) {
    if (!asked.surface.placement().covers(f.point)) continue;  // the texture goes on, the rectangle does not
    const bool is_least = std::all_of(around.begin(), around.end(), [&](const Vec3& edge) {
      return f.direction.dot(edge) >= -corner_slack;
    });
    if (!is_least) continue;
    asked.found.add({f.point, f.direction, f.distance - radius,
                     feature_id(f.cell_i, f.cell_j, part, index, asked.child)});
  }
}

}  // namespace

void ball_pairs(const Asked& asked, const Vec3& centre, double radius, int index) {
  std::array<Feature, ContactSet::capacity> features;
  const std::size_t count =
      closest_features(asked.surface, centre, radius + asked.found.limit(), min_angle, features);
  add_all(asked, std::span(features).first(count), {}, radius, Part::round, index);
}

void corner_pairs(const Asked& asked, const Vec3& corner, std::span<const Vec3> around, double radius,
                  int index) {
  const double limit = radius + asked.found.limit();
  if (corner.z() > limit) return;
  const surface::Placement& place = asked.surface.placement();
  if (corner.x() < -limit || corner.y() < -limit || corner.x() > place.size_u() + limit ||
      corner.y() > place.size_v() + limit)
    return;
  const double gap = corner.z() + asked.surface.depth(place.uv(corner));
  if (gap > 0 || radius > 0) {
    std::array<Feature, 4> features;
    const std::size_t count = closest_features(asked.surface, corner, limit, min_angle, features);
    add_all(asked, std::span(features).first(count), around, radius, Part::vertex, index);
  } else if (const auto nearest = closest_point(asked.surface, corner)) {
    add_all(asked, std::span(&*nearest, 1), around, radius, Part::vertex, index);
  }
}

}  // namespace intaglio::contact
