// A cylinder: its axis as a rod with a radius, two flat ends, two rims.
#include <cmath>

#include "intaglio/contact/feet.h"
#include "intaglio/contact/pairs.h"
#include "intaglio/contact/side_pairs.h"

namespace intaglio::contact {

void cylinder_pairs(const Asked& asked, const Cylinder& cylinder, const Frame& frame) {
  const Vec3 axis = frame.axes.col(1), reach = cylinder.half_height * axis;
  const double r = cylinder.radius;
  // Lowest points first: on a plane there are no others.
  feet::of(cylinder, frame, [&](const Foot& foot) {
    const Vec3 end = foot.index & 1 ? axis : Vec3(-axis);
    const Vec3 out = (foot.point - frame.origin - cylinder.half_height * end) / r;
    const std::array<Vec3, 2> around = {-end, -out};
    corner_pairs(asked, foot.point, around, 0, foot.index);
  });
  edge_pairs(asked, {frame.origin - reach, frame.origin + reach, {}, r, 2});
  for (const int end : {0, 1}) {
    const Vec3 normal = end == 0 ? Vec3(-axis) : axis, centre = frame.origin + cylinder.half_height * normal;
    // What a disc reaches in plan.
    const Vec2 aside(r * std::sqrt(std::max(0.0, 1 - axis.x() * axis.x())),
                     r * std::sqrt(std::max(0.0, 1 - axis.y() * axis.y())));
    rim_pairs(asked, {centre, normal, r, end});
    if (!(normal.z() < 0)) continue;
    const auto inside = [&](const Vec3& q, double distance, const auto&) {
      const Vec3 from = q - centre;
      const double beside = (from - from.dot(normal) * normal).norm() - r;
      return beside <= (distance < 0 ? 0.5 * distance : 0);
    };
    side_pairs(asked, {normal, normal.dot(centre), centre.head<2>() - aside, centre.head<2>() + aside, end},
               inside);
  }
}

}  // namespace intaglio::contact
