#include "intaglio/session/live/mouse_device.h"

namespace intaglio::session {

MouseDevice::MouseDevice(const haptics::DeviceModel& model, const haptics::Hand& hand, const Vec3& start)
    : model_(model), hand_(hand), wanted_(start), position_(start) {
  target_.publish(start);
}

Vec3 MouseDevice::read() {
  const double dt = 1 / model_.rate;
  const Vec3 way = target_.fetch() - wanted_;
  const double far = way.norm();
  const Vec3 step = far > speed * dt ? Vec3(way * (speed * dt / far)) : way;
  wanted_ += step;
  // Semi-implicit Euler with the hand's damper taken implicitly, as haptics/devices/simulated.cpp.
  const Vec3 push = hand_.stiffness * (wanted_ - position_) + hand_.damping * step / dt + force_;
  velocity_ = (velocity_ + dt / hand_.mass * push) / (1 + dt * hand_.damping / hand_.mass);
  position_ += dt * velocity_;
  return (position_ / model_.resolution).array().round().matrix() * model_.resolution;
}

}  // namespace intaglio::session
