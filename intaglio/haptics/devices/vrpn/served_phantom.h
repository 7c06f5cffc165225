// The PHANToM that `intaglio devices serve` shows: a simulated device in a simulated hand that goes round and
// down and up again, two buttons, and the force that a client asks for, through a guard.
//
// Whoever asks must go on asking: `silence` seconds after the last word the force is zero, and the next one
// ramps in anew. tick() allocates nothing. One thread.
#pragma once

#include <chrono>

#include "intaglio/haptics/devices/simulated.h"
#include "intaglio/haptics/devices/vrpn/asked_force.h"

namespace intaglio::haptics::vrpn {

struct PhantomOptions {
  DeviceModel model;
  Hand hand;
  GuardLimits limits;
  PlaneUnits units;
  std::vector<Waypoint> path;  // empty: round and round for twelve hours
  double silence = 0.040;      // s
};

struct PhantomState {
  Vec3 position = Vec3::Zero();  // m, as the encoders report it
  Vec3 velocity = Vec3::Zero();  // m/s, filtered
  Vec3 force = Vec3::Zero();     // N, on the hand
  bool clamped = false;          // more was asked for than the device can
  std::optional<Vec3> contact;   // on the plane touched
  std::array<std::int32_t, 2> buttons = {};
};

class ServedPhantom {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit ServedPhantom(const PhantomOptions& options);

  // A message of a client: ForceReport, PlaneMessage or ForceField.
  template <class Asked>
  void ask(const Asked& asked, Time now) {
    if (!asked_.any()) guard_.rearm();
    asked_.set(asked);
    asked_at_ = now;
  }
  // The client is gone.
  void release() { asked_.clear(); }
  bool held() const { return asked_.any(); }

  // Lets `dt` seconds pass.
  void tick(double dt, Time now);
  const PhantomState& state() const { return state_; }

 private:
  PhantomOptions options_;
  SimulatedDevice device_;
  Guard guard_;
  AskedForce asked_;
  Time asked_at_;
  PhantomState state_;
};

}  // namespace intaglio::haptics::vrpn
