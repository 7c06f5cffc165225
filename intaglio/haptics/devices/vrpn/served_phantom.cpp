#include "intaglio/haptics/devices/vrpn/served_phantom.h"

#include <cmath>
#include <numbers>

#include "intaglio/core/elementary.h"

namespace intaglio::haptics::vrpn {

static constexpr double lap = 4;               // s
static constexpr double lasting = 12 * 3600;   // s
static constexpr double velocity_cutoff = 60;  // Hz

// A circle of 3 cm, from 2 cm above the middle of the workspace to 1 cm below.
static std::vector<Waypoint> laps() {
  std::vector<Waypoint> path;
  for (int k = 0; k * lap / 8 <= lasting; ++k) {
    const double angle = k * std::numbers::pi / 4;
    path.push_back({k * lap / 8,
                    {0.03 * elementary::cos(angle), 0.005 + 0.015 * elementary::cos(angle),
                     0.03 * elementary::sin(angle)}});
  }
  return path;
}

ServedPhantom::ServedPhantom(const PhantomOptions& options)
    : options_(options),
      device_(options.model, options.hand, options.path.empty() ? laps() : options.path),
      guard_(options.limits),
      asked_(options.units) {
  state_.position = device_.read();
}

void ServedPhantom::tick(double dt, Time now) {
  if (asked_.any() && std::chrono::duration<double>(now - asked_at_).count() > options_.silence) release();
  const Vec3 position = device_.read();
  const double keep = elementary::exp(-2 * std::numbers::pi * velocity_cutoff * dt);
  state_.velocity = keep * state_.velocity + (1 - keep) * (position - state_.position) / dt;
  state_.position = position;
  state_.contact = asked_.contact(position);
  const Vec3 wanted = asked_.newtons(position, state_.velocity);
  state_.too_much = wanted.norm() > options_.limits.peak_force;
  const GuardedForce guarded = guard_.pass(wanted, dt);
  state_.force = guarded.newtons();
  device_.write(guarded);
  device_.advance(dt);
  // The hand holds the first button for the third quarter of each lap.
  state_.buttons[0] =
      std::fmod(device_.time(), lap) >= lap / 2 && std::fmod(device_.time(), lap) < 0.75 * lap;
}

}  // namespace intaglio::haptics::vrpn
