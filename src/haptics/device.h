// The interface of a haptic device: a position to read, a guarded force to write. And a simulated one.
#pragma once

#include <optional>
#include <vector>

#include "haptics/guard.h"
#include "intaglio/vec.h"

namespace intaglio::haptics {

class Device {
 public:
  virtual ~Device() = default;

  // Position of the tip in the device's own workspace, metres, as its encoders report it.
  virtual Vec3 read() = 0;
  // The force on the hand until the next write, and the torque for a device that displays it (guard.h: torque
  // is zero unless the guard's limits allow some).
  virtual void write(const GuardedForce& force) = 0;

  // The rotation from an upright pen (shaft along +Y) to the grip's; called only when reads_orientation().
  virtual bool reads_orientation() const { return false; }
  virtual Quat orientation() { return Quat::Identity(); }
  // Seconds since the device last answered; 0 for a device that answers every read.
  virtual double silent_for() const { return 0; }
};

// Is where it is told to be and displays nothing: for a servo that describes what a pen meets whose force
// another servo makes (PenServo::set_contact). Real-time.
class EchoDevice : public Device {
 public:
  void set(const Vec3& tip, const std::optional<Quat>& orientation, double silent_for) {
    tip_ = tip;
    orientation_ = orientation;
    silent_for_ = silent_for;
  }

  Vec3 read() override { return tip_; }
  void write(const GuardedForce& /*force*/) override {}
  bool reads_orientation() const override { return orientation_.has_value(); }
  Quat orientation() override { return orientation_.value_or(Quat::Identity()); }
  double silent_for() const override { return silent_for_; }

 private:
  Vec3 tip_ = Vec3::Zero();
  std::optional<Quat> orientation_;
  double silent_for_ = 0;
};

// A simulated PHANToM Desktop in a simulated hand.
//
// The hand pulls the grip along a scripted path with a spring and a damper; device and hand together have a
// mass. Encoders have the PHANToM's resolution. Deterministic; real-time (no allocation after construction).

// The hand's target at a time; between waypoints the path is a Catmull-Rom curve.
struct Waypoint {
  double time = 0;               // s
  Vec3 position = Vec3::Zero();  // m, device workspace
};

struct Hand {
  double mass = 0.12;      // kg, of hand and device together at the tip
  double stiffness = 350;  // N/m
  double damping = 6;      // N s/m
};

struct DeviceModel {
  double resolution = 2.3e-5;               // m, of the encoders
  Vec3 workspace = Vec3(0.16, 0.12, 0.12);  // m
  double peak_force = 7.9;                  // N
  double rate = 1000;                       // Hz
};

class SimulatedDevice : public Device {
 public:
  // `path` is ordered by time and not empty.
  SimulatedDevice(const DeviceModel& model, const Hand& hand, std::vector<Waypoint> path);

  Vec3 read() override;
  void write(const GuardedForce& force) override { force_ = force.newtons(); }

  // Moves hand and device for `dt` seconds under the force last written.
  void advance(double dt);

  double time() const { return time_; }
  const Vec3& position() const { return position_; }  // exact, not rounded by the encoders
  // The hand's target at time t, metres.
  Vec3 target(double t) const;

 private:
  DeviceModel model_;
  Hand hand_;
  std::vector<Waypoint> path_;
  Vec3 position_, velocity_ = Vec3::Zero(), force_ = Vec3::Zero();
  double time_ = 0;
};

}  // namespace intaglio::haptics
