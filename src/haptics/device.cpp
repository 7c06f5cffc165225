#include "haptics/device.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace intaglio::haptics {

SimulatedDevice::SimulatedDevice(const DeviceModel& model, const Hand& hand, std::vector<Waypoint> path)
    : model_(model), hand_(hand), path_(std::move(path)) {
  assert(!path_.empty());
  position_ = path_.front().position;
}

Vec3 SimulatedDevice::read() {
  const Vec3 half = 0.5 * model_.workspace;
  const Vec3 reached = position_.cwiseMax(-half).cwiseMin(half);
  return (reached / model_.resolution).array().round().matrix() * model_.resolution;
}

Vec3 SimulatedDevice::target(double t) const {
  const auto after = std::upper_bound(path_.begin(), path_.end(), t,
                                      [](double time, const Waypoint& w) { return time < w.time; });
  if (after == path_.begin()) return path_.front().position;
  if (after == path_.end()) return path_.back().position;
  // Cubic Hermite curve; the tangent at a waypoint is the mean velocity between its neighbours, and zero at
  // both ends of the path.
  const auto k = std::size_t(after - path_.begin()) - 1;
  const auto tangent = [&](std::size_t i) -> Vec3 {
    if (i == 0 || i + 1 == path_.size()) return Vec3::Zero();
    return (path_[i + 1].position - path_[i - 1].position) / (path_[i + 1].time - path_[i - 1].time);
  };
  const double span = path_[k + 1].time - path_[k].time;
  const double s = (t - path_[k].time) / span;
  const double s2 = s * s;
  const double s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * path_[k].position + (s3 - 2 * s2 + s) * span * tangent(k) +
         (3 * s2 - 2 * s3) * path_[k + 1].position + (s3 - s2) * span * tangent(k + 1);
}

void SimulatedDevice::advance(double dt) {
  // Semi-implicit Euler with an implicit damper: stable for any hand at servo rates.
  const Vec3 goal = target(time_ + dt);
  const Vec3 goal_velocity = (goal - target(time_)) / dt;
  const Vec3 push = hand_.stiffness * (goal - position_) + hand_.damping * goal_velocity + force_;
  velocity_ = (velocity_ + dt / hand_.mass * push) / (1 + dt * hand_.damping / hand_.mass);
  position_ += dt * velocity_;
  time_ += dt;
}

}  // namespace intaglio::haptics
