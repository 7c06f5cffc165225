#include "haptics/vrpn/served_phantom.h"

#include <cmath>
#include <numbers>

#include "core/portable_math.h"

namespace intaglio::haptics::vrpn {

namespace {

constexpr double lap_time = 4;               // s
constexpr double path_duration = 12 * 3600;  // s
constexpr double velocity_cutoff = 60;       // Hz

// A circle of 3 cm, from 2 cm above the middle of the workspace to 1 cm below.
std::vector<Waypoint> circular_path() {
  std::vector<Waypoint> path;
  for (int k = 0; k * lap_time / 8 <= path_duration; ++k) {
    const double angle = k * std::numbers::pi / 4;
    path.push_back({k * lap_time / 8,
                    {0.03 * elementary::cos(angle), 0.005 + 0.015 * elementary::cos(angle),
                     0.03 * elementary::sin(angle)}});
  }
  return path;
}

}  // namespace

ServedPhantom::ServedPhantom(const PhantomOptions& options)
    : options_(options),
      device_(options.model, options.hand, options.path.empty() ? circular_path() : options.path),
      guard_(options.limits),
      requested_(options.units) {
  state_.position = device_.read();
}

void ServedPhantom::tick(double dt, SteadyTime now) {
  if (requested_.is_active() && std::chrono::duration<double>(now - requested_at_).count() > options_.silence)
    release();
  const Vec3 position = device_.read();
  const double keep = elementary::exp(-2 * std::numbers::pi * velocity_cutoff * dt);
  state_.velocity = keep * state_.velocity + (1 - keep) * (position - state_.position) / dt;
  state_.position = position;
  state_.contact = requested_.contact(position);
  const Vec3 wanted = requested_.newtons(position, state_.velocity);
  state_.over_limit = wanted.norm() > options_.limits.peak_force;
  const GuardedForce guarded = guard_.pass(wanted, dt);
  state_.force = guarded.newtons();
  device_.write(guarded);
  device_.advance(dt);
  // The hand presses the first button in the third quarter of each lap.
  state_.buttons[0] = std::fmod(device_.time(), lap_time) >= lap_time / 2 &&
                      std::fmod(device_.time(), lap_time) < 0.75 * lap_time;
}

}  // namespace intaglio::haptics::vrpn
