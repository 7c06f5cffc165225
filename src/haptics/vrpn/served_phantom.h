// The simulated PHANToM that a server shows.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <vector>

#include "haptics/device.h"
#include "haptics/vrpn/connection.h"
#include "haptics/vrpn/force.h"

namespace intaglio::haptics::vrpn {

struct PhantomOptions {
  DeviceModel model;
  Hand hand;
  GuardLimits limits;
  PlaneUnits units;
  std::vector<Waypoint> path;  // empty: a circle, for twelve hours
  double silence = 0.040;      // s, after which a request expires
};

struct PhantomState {
  Vec3 position = Vec3::Zero();  // m, as the encoders report it
  Vec3 velocity = Vec3::Zero();  // m/s, filtered
  Vec3 force = Vec3::Zero();     // N, on the hand
  bool over_limit = false;       // more than the peak force is requested
  std::optional<Vec3> contact;   // on the plane touched
  std::array<std::int32_t, 2> buttons = {};
};

// The PHANToM of `intaglio devices serve`: a simulated device in a simulated hand that moves on an inclined
// circle, two buttons, and the force requested by a client, through a guard.
//
// Requests must be renewed: the force drops to zero `silence` seconds after the last one, and the next one
// ramps in anew. tick() does not allocate. One thread.
class ServedPhantom {
 public:
  explicit ServedPhantom(const PhantomOptions& options);

  // `requested` is a ForceReport, PlaneMessage or ForceField.
  template <class Request>
  void request(const Request& requested, SteadyTime now) {
    if (!requested_.is_active()) guard_.rearm();
    requested_.set(requested);
    requested_at_ = now;
  }
  void release() { requested_.clear(); }
  bool is_held() const { return requested_.is_active(); }

  // Advances by `dt` seconds.
  void tick(double dt, SteadyTime now);
  const PhantomState& state() const { return state_; }

 private:
  PhantomOptions options_;
  SimulatedDevice device_;
  Guard guard_;
  RequestedForce requested_;
  SteadyTime requested_at_;
  PhantomState state_;
};

}  // namespace intaglio::haptics::vrpn
