#include "sound/strike.h"

#include <cmath>
#include <numbers>

namespace intaglio::sound {

namespace {

constexpr double step_duration = 1e-3;  // s; the blow is in its middle

}  // namespace

double Mallet::mass() const {
  return material.density * 4 / 3 * std::numbers::pi * radius * radius * radius;
}

SurfacePoint nearest_surface(const ModalModel& model, const Vec3& point) {
  const TrianglePoint at = model.grid.nearest(point, model.points, model.triangles);
  const Triangle& t = model.triangles[std::size_t(at.triangle)];
  const auto corner = [&](std::size_t k) { return model.points[std::size_t(t[k])]; };
  return {at.barycentric[0] * corner(0) + at.barycentric[1] * corner(1) + at.barycentric[2] * corner(2),
          triangle_cross(model.points, t).normalized()};
}

Vec3 default_strike_point(const ModalModel& model) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : model.points) box.extend(p);
  const Vec3 half = 0.5 * box.sizes();
  int across = 1;
  for (const int axis : {2, 0}) {
    if (half[axis] < 0.999 * half[across]) across = axis;
  }
  Vec3 target;
  target[across] = half[across];
  target[(across + 1) % 3] = 0.37 * half[(across + 1) % 3];
  target[(across + 2) % 3] = 0.29 * half[(across + 2) % 3];
  return nearest_surface(model, box.center() + target).point;
}

std::vector<SoundBody> strike_bodies(std::shared_ptr<const ModalModel> model, const Strike& strike) {
  SoundBody struck;
  struck.id = struck_body;
  struck.mass = model->mass;
  struck.model = std::move(model);
  SoundBody mallet;
  mallet.id = mallet_body;
  mallet.mass = strike.mallet.mass();
  mallet.radius_of_curvature = strike.mallet.radius;
  mallet.material = strike.mallet.material;
  return {struck, mallet};
}

ContactEvent strike_event(const ModalModel& model, const Strike& strike, double time) {
  const SurfacePoint at = nearest_surface(model, strike.at.value_or(default_strike_point(model)));
  const Vec3 push = strike.direction.value_or(-at.normal).normalized();
  const double mallet = strike.mallet.mass(), effective = 1 / (1 / mallet + 1 / model.mass);
  const double rebound = 1 + strike.mallet.material.restitution * model.material.restitution;
  ContactEvent event;
  event.time = time + 0.5 * step_duration;
  event.duration = step_duration;
  event.body = mallet_body;
  event.other = struck_body;
  event.phase = ContactPhase::begin;
  event.point = at.point;
  event.n_g = event.n_s = at.normal;
  event.impulse = -strike.impulse.value_or(effective * rebound) * push;  // on the mallet
  event.body_pose.position = at.point;
  return event;
}

}  // namespace intaglio::sound
