#include "intaglio/contact/round_pairs.h"

#include "intaglio/surface/closest.h"

namespace intaglio::contact {

void ball_pairs(const surface::Surface& surface, const Vec3& centre, double radius, int index, int child,
                Candidates& found) {
  std::array<surface::Feature, ContactSet::capacity> features;
  const std::size_t count = closest_features(surface, centre, radius + found.limit(), min_angle, features);
  for (std::size_t k = 0; k < count; ++k) {
    const surface::Feature& f = features[k];
    if (!surface.placement().covers(f.point)) continue;  // the texture goes on, the rectangle does not
    found.add({f.point, f.direction, f.distance - radius,
               feature_id(f.cell_i, f.cell_j, Part::round, index, child)});
  }
}

}  // namespace intaglio::contact
