#include "intaglio/dynamics/bounce.h"

#include <algorithm>
#include <cmath>

namespace intaglio::dynamics {

namespace {

constexpr double least_closing = 1e-3;  // m/s, of a touch that has a time
constexpr double at_once = 0.02;        // of a step

// When a contact that was not pressed before closes, s after the step's start: up to half a step before it,
// when it bounces late. A body that contacts hold comes at the speed that they leave it; one that flies, on
// the parabola through where it is at the ends of steps (steps end with the speed of their end, half a step's
// gain too much).
std::optional<double> touch_time(const contact::ContactPoint& c, const Approach& approach,
                                 const Vec3& held_velocity, double slack) {
  const bool flies = held_velocity == approach.velocity || c.distance <= slack;
  const Vec3 velocity = flies ? Vec3(approach.velocity - 0.5 * approach.gain) : held_velocity;
  const double closing = -(velocity + approach.spin.cross(c.point - approach.pose.position)).dot(c.normal);
  // What lies still on one texel after the other presses anew on each, with no more speed than a step's fall.
  const double still =
      c.distance > slack ? 0 : 0.5 * approach.gain.norm() + std::max(0.0, -approach.gain.dot(c.normal));
  if (!(closing > least_closing + still)) return std::nullopt;
  const double gain = flies ? -approach.gain.dot(c.normal) / approach.dt : 0;
  const double root = std::sqrt(std::max(0.0, closing * closing + 2 * gain * c.distance));
  return std::clamp(2 * c.distance / (closing + root), -0.5 * approach.dt, approach.dt);
}

// The contacts of one body, some of which bounce.
struct Bouncing {
  const Ahead& contacts;
  const Approach& approach;
  double restitution;
  Meetings& met;
  std::array<double, contact::ContactSet::capacity>
      speed{};  // m/s, of closing at the step's end; 0: no bounce

  // Whether it closes within this step's half.
  bool is_due(std::size_t k, double closing) const {
    return std::max(contacts.points[k].distance, 0.0) <= 0.5 * closing * approach.dt;
  }
  // The one that closes before the others.
  std::optional<std::size_t> first() const {
    std::optional<std::size_t> out;
    for (std::size_t k = 0; k < contacts.count; ++k) {
      if (speed[k] > 0 && met[k].touch && is_due(k, speed[k]) && (!out || *met[k].touch < *met[*out].touch))
        out = k;
    }
    return out;
  }
  // How fast `k` closes after the bounce off `other`.
  double left_by(std::size_t other, std::size_t k) const {
    const double along = contacts.points[other].normal.dot(contacts.points[k].normal);
    return speed[k] - (1 + restitution) * speed[other] * along;
  }
};

}  // namespace

Meetings meetings(const Ahead& contacts, const Approach& approach, double restitution, double least,
                  double slack) {
  Meetings out;
  Bouncing bouncing{contacts, approach, restitution, out};
  const Vec3 held = approach.held_velocity(contacts, slack);
  for (std::size_t k = 0; k < contacts.count; ++k) {
    const contact::ContactPoint& c = contacts.points[k];
    const double closing = -approach.velocity_at(c.point).dot(c.normal);
    // Of what rests gravity's gain is all there is.
    const bool bounces = restitution > 0 && closing + approach.gain.dot(c.normal) > least;
    bouncing.speed[k] = bounces ? closing : 0;
    out[k].touch = touch_time(c, approach, held, slack);
    out[k].distance = k < contacts.now ? c.distance : std::max(c.distance, 0.0);
  }
  const bool is_ball = approach.lever == 0;
  const auto first = bouncing.first();
  for (std::size_t k = 0; k < contacts.count; ++k) {
    if (bouncing.speed[k] == 0) continue;
    double left = bouncing.speed[k];
    if (is_ball && first && out[k].touch && *out[k].touch > *out[*first].touch + at_once * approach.dt)
      left = bouncing.left_by(*first, k);
    out[k].waits = !(left > 0 && bouncing.is_due(k, left));
    out[k].distance = std::min(out[k].distance, 0.0);
    out[k].restitution = restitution * left / bouncing.speed[k];
  }
  // Which of a ball's contacts bears its bounces off two in one step is the solver's choice.
  for (std::size_t k = 0; is_ball && first && k < contacts.count; ++k)
    if (bouncing.speed[k] > 0) out[k].touch = out[*first].touch;
  return out;
}

}  // namespace intaglio::dynamics
