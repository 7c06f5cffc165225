#include "evaluate/reference_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace intaglio::evaluate {

ReferenceBall::ReferenceBall(const Reference& truth, double radius, const Material& ball,
                             const Material& floor, double rate)
    : truth_(truth),
      radius_(radius),
      mass_(ball.density * 4.0 / 3 * std::numbers::pi * radius * radius * radius),
      inertia_(0.4 * mass_ * radius * radius),
      friction_(std::sqrt(ball.friction * floor.friction)),
      restitution_(ball.restitution * floor.restitution),
      rolling_(ball.rolling_resistance + floor.rolling_resistance),
      dt_(1 / rate) {}

void ReferenceBall::find_contacts() {
  contacts_.clear();
  // The distance that the ball may cover within a step.
  const double margin = 1e-4 + state_.velocity.norm() * dt_;
  for (const Nearest& near : truth_.nearest(state_.pose.position, radius_ + margin)) {
    if (!(near.distance > 0)) continue;
    const Vec3 normal = (state_.pose.position - near.point) / near.distance;
    const double gap = near.distance - radius_;
    const double closing = -normal.dot(state_.velocity);
    // A contact that closes within the step bounces; one that merely carries the weight does not.
    const double weight_speed = 3 * 9.81 * dt_;
    double wanted = gap > 0 ? -gap / dt_ : std::min(0.1 * -gap / dt_, 0.2);
    if (closing > weight_speed + std::max(gap, 0.0) / dt_) wanted = std::max(wanted, restitution_ * closing);
    contacts_.push_back({normal, near.point - state_.pose.position, gap, wanted});
  }
}

void ReferenceBall::solve() {
  touches_ = false;
  for (int iteration = 0; iteration < 30; ++iteration) {
    for (Contact& c : contacts_) {
      const double push = mass_ * (c.wanted - c.normal.dot(state_.velocity));
      const double sum = std::max(c.normal_impulse + push, 0.0);
      state_.velocity += (sum - c.normal_impulse) / mass_ * c.normal;
      c.normal_impulse = sum;
      const Vec3 at = state_.velocity + state_.angular_velocity.cross(c.arm);
      const Vec3 slip = at - c.normal.dot(at) * c.normal;
      const double mobility = 1 / mass_ + radius_ * radius_ / inertia_;
      Vec3 wanted = c.friction_impulse - slip / mobility;
      const double most = friction_ * c.normal_impulse;
      if (wanted.norm() > most) wanted *= most / wanted.norm();
      const Vec3 change = wanted - c.friction_impulse;
      state_.velocity += change / mass_;
      state_.angular_velocity += c.arm.cross(change) / inertia_;
      c.friction_impulse = wanted;
    }
  }
  for (const Contact& c : contacts_) touches_ = touches_ || c.normal_impulse > 0;
}

// A moment against the rotation, of the rolling resistance times the normal force times the radius.
void ReferenceBall::resist_rolling(double normal_impulse) {
  const double most = rolling_ * normal_impulse * radius_ / inertia_;
  const double spin = state_.angular_velocity.norm();
  if (spin > 0) state_.angular_velocity *= std::max(0.0, 1 - most / spin);
}

void ReferenceBall::step() {
  state_.velocity.z() -= 9.81 * dt_;
  find_contacts();
  solve();
  double normal_impulse = 0;
  for (const Contact& c : contacts_) normal_impulse += c.normal_impulse;
  resist_rolling(normal_impulse);
  state_.pose.position += dt_ * state_.velocity;
  state_.pose.orientation = (rotation(dt_ * state_.angular_velocity) * state_.pose.orientation).normalized();
}

std::vector<TouchPoint> ReferenceBall::touch_points() const {
  std::vector<TouchPoint> out;
  for (const Contact& c : contacts_)
    if (c.normal_impulse > 0)
      out.push_back(
          {state_.pose.position + c.arm, c.normal, c.normal_impulse * c.normal + c.friction_impulse});
  return out;
}

std::vector<Vec3> ReferenceBall::normals_at(const Vec3& centre) const {
  std::vector<Vec3> out;
  for (const Nearest& near : truth_.nearest(centre, 1.02 * radius_))
    if (near.distance > 0) out.push_back((centre - near.point) / near.distance);
  return out;
}

double ReferenceBall::energy() const {
  return 0.5 * mass_ * state_.velocity.squaredNorm() +
         0.5 * inertia_ * state_.angular_velocity.squaredNorm() + mass_ * 9.81 * state_.pose.position.z();
}

Vec3 ReferencePen::follow(const Vec3& hand) {
  const auto on_relief = [&](const Vec2& p) { return Vec3(p.x(), p.y(), truth_.rest_on(p, radius_).z); };
  const Vec3 above = on_relief(hand.head<2>());
  if (hand.z() >= above.z()) {
    tip_ = hand;
    touches_ = false;
    return Vec3::Zero();
  }
  if (!touches_) tip_ = above;
  touches_ = true;
  // Descends the distance to the hand over the relief, as long as the spring pulls out of the cone.
  const double step = 0.25 * radius_;
  Vec2 p = tip_.head<2>();
  tip_ = on_relief(p);
  double reach = step;
  for (int k = 0; k < 60 && reach > 1e-4 * radius_; ++k) {
    const Vec2 slope = truth_.rest_on(p, radius_).slope;
    const Vec3 normal = Vec3(-slope.x(), -slope.y(), 1).normalized();
    const Vec3 pull = hand - tip_;
    const double press = -normal.dot(pull);
    const Vec3 along = pull + press * normal;
    if (press > 0 && along.norm() <= friction_ * press) break;
    // Friction holds back what it can; the tip moves until the pull is within the cone.
    const double left = press > 0 ? along.norm() - friction_ * press : along.norm();
    const Vec2 direction = along.head<2>();
    if (direction.norm() < 1e-15) break;
    const double way = std::min(reach, left * direction.norm() / along.norm());
    const Vec3 next = on_relief(p + way * direction.normalized());
    if ((hand - next).squaredNorm() < pull.squaredNorm()) {
      tip_ = next;
      p = next.head<2>();
    } else {
      reach *= 0.5;
    }
  }
  return stiffness_ * (tip_ - hand);
}

}  // namespace intaglio::evaluate
