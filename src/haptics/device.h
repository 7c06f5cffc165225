// What a haptic device is to the servo loop: a position to read, a guarded force to write.
#pragma once

#include <vector>

#include "haptics/guard.h"
#include "intaglio/vec.h"

namespace intaglio::haptics {

class Device {
 public:
  virtual ~Device() = default;

  // Position of the tip in the device's own workspace, metres, as its encoders report it.
  virtual Vec3 read() = 0;
  // The force (and torque, where displays_torque()) on the hand until the next write.
  virtual void write(const GuardedForce& force) = 0;

  // Turns the pen from upright (shaft along +Y) to how the grip is held. Asked only of devices that know.
  virtual bool reads_orientation() const { return false; }
  virtual Quat orientation() { return Quat::Identity(); }
  // 6-DOF devices display torque about the grip; to the others it is not sent.
  virtual bool displays_torque() const { return false; }
  // Seconds since the device was last heard of; 0 where it answers every read.
  virtual double silent_for() const { return 0; }
};

// A simulated PHANToM Desktop in a simulated hand.
//
// The hand holds the grip with a spring and a damper and wants it to be on a scripted path; device and hand
// together have a mass. Encoders have the PHANToM's resolution. Deterministic; real-time (no allocation after
// construction).

// Where the hand wants the tip to be at a time: between waypoints the path is a smooth Catmull-Rom curve.
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
  // `path` is ordered in time and not empty.
  SimulatedDevice(const DeviceModel& model, const Hand& hand, std::vector<Waypoint> path);

  Vec3 read() override;
  void write(const GuardedForce& force) override { force_ = force.newtons(); }

  // Lets hand and device move for `dt` seconds under the force last written.
  void advance(double dt);

  double time() const { return time_; }
  const Vec3& position() const { return position_; }  // true, before the encoders
  // Where the hand wants the tip at time t, metres.
  Vec3 wanted(double t) const;

 private:
  DeviceModel model_;
  Hand hand_;
  std::vector<Waypoint> path_;
  Vec3 position_, velocity_ = Vec3::Zero(), force_ = Vec3::Zero();
  double time_ = 0;
};

}  // namespace intaglio::haptics
