#include <cmath>

#include "intaglio/contact/pairs.h"
#include "intaglio/contact/slack.h"
#include "intaglio/surface/closest.h"

namespace intaglio::contact {

namespace {

using surface::Feature;

// Which of the cells that meet there the search found does not matter to the name.
std::uint64_t name_of(const surface::Surface& surface, const Vec3& point, Part part, int index, int child) {
  constexpr double near = 1e-6;
  const double x = point.x() / surface.texel_u() - 0.5, y = point.y() / surface.texel_v() - 0.5;
  const double i = std::floor(x + near), j = std::floor(y + near);
  const bool on_column = x - i < near, on_row = y - j < near;
  const Where where =
      on_column ? (on_row ? Where::corner : Where::crease_y) : (on_row ? Where::crease_x : Where::patch);
  return feature_id(static_cast<int>(i), static_cast<int>(j), where, part, index, child);
}

void add_all(const Asked& asked, std::span<const Feature> features, std::span<const Vec3> around,
             double radius, Part part, int index) {
  for (const Feature& f : features) {
    if (!asked.surface.placement().covers(f.point)) continue;  // the texture goes on, the rectangle does not
    const bool is_least = std::all_of(around.begin(), around.end(), [&](const Vec3& edge) {
      return f.direction.dot(edge) >= -corner_slack;
    });
    const Candidate candidate{f.point, f.direction, f.distance - radius,
                              name_of(asked.surface, f.point, part, index, asked.child)};
    if (is_least) {
      asked.found.add(candidate);
    } else if (f.distance < 0) {
      asked.found.add_spare(candidate);
    }
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
