#include "intaglio/dynamics/touchable_shape.h"

#include <algorithm>

#include "intaglio/contact/curved_on_curved.h"
#include "intaglio/contact/curved_on_relief.h"
#include "intaglio/contact/relief_relief.h"
#include "intaglio/dynamics/curved_shape.h"
#include "intaglio/dynamics/textured_shape.h"

namespace intaglio::dynamics {

namespace {

// The same contacts with the roles changed, in the frame of the other, which is at `pose` in this one.
contact::ContactSet turned_round(contact::ContactSet set, const Pose& pose) {
  for (std::size_t k = 0; k < set.count; ++k) {
    contact::ContactPoint& c = set.points[k];
    c.point = pose.to_local(c.point + c.distance * c.normal);
    c.normal = pose.orientation.conjugate() * -c.normal;
    c.n_s = c.normal;
  }
  return set;
}

Pose inverse(const Pose& pose) {
  return {pose.orientation.conjugate() * -pose.position, pose.orientation.conjugate()};
}

}  // namespace

contact::ContactSet TouchableShape::within_thickness(contact::ContactSet set) const {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < set.count; ++k)
    if (set.points[k].distance >= -thickness_) set.points[kept++] = set.points[k];
  set.count = kept;
  return set;
}

contact::ContactSet touch_of_reliefs(const TouchableShape& body, const Pose& pose,
                                     const TouchableShape& ground, double margin) {
  const auto* flat_body = dynamic_cast<const TexturedShape*>(&body);
  const auto* flat_ground = dynamic_cast<const TexturedShape*>(&ground);
  const auto* curved_body = dynamic_cast<const CurvedShape*>(&body);
  const auto* curved_ground = dynamic_cast<const CurvedShape*>(&ground);
  if (flat_body && flat_ground) {
    // Faces that look the same way are back to front, as near as they may be.
    const Vec3 up = pose.orientation * flat_body->relief().placement().n();
    if (up.dot(flat_ground->relief().placement().n()) > 0.5) return {};
    return contact::relief_relief_contacts({flat_body->relief(), pose}, {flat_ground->relief(), {}}, margin);
  }
  // Of a curved body many pieces are nearly as low as the lowest: what is farther ahead is found when it is
  // nearer.
  margin = std::min(margin, 0.3 * std::min(body.texel(), ground.texel()));
  if (curved_body && flat_ground)
    return body.within_thickness(contact::curved_on_relief(curved_body->relief(), pose, flat_ground->relief(),
                                                           margin, ground.thickness()));
  if (flat_body && curved_ground) {
    const Pose back = inverse(pose);
    return ground.within_thickness(
        turned_round(contact::curved_on_relief(curved_ground->relief(), back, flat_body->relief(), margin,
                                               body.thickness()),
                     back));
  }
  if (curved_body && curved_ground) {
    // So deep that nothing falls through from step to step, and not so deep that all of a small body is in.
    const double size = curved_body->relief().bounds().sizes().minCoeff();
    const double depth = std::min({0.25 * size, body.thickness(), ground.thickness()});
    return contact::curved_on_curved(curved_body->relief(), pose, curved_ground->relief(), margin, depth);
  }
  return {};
}

}  // namespace intaglio::dynamics
