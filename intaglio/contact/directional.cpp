#include <algorithm>
#include <cmath>
#include <limits>

#include "intaglio/contact/lower_height.h"
#include "intaglio/contact/question.h"
#include "intaglio/contact/relief.h"

namespace intaglio::contact {

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
