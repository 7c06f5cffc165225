// One tick of the haptic loop: device, contact, friction, passivity, guard, device.
//
// Two methods. `potential`, the default: the surface is sampled every tick and the force comes from a stored
// energy (proxy.h), so that no texture can feed energy to the hand. `plane`: the paper's, a plane once per
// video frame (held_plane.h).
//
// Springs act in world metres and are specified in device metres. In a workspace that shows s world metres
// per device metre, a spring of K at the hand is K / s^2 in the world, and a force f in the world is s f at
// the hand: f dx is the same energy in both.
//
// A study may delay the force or withhold it (ServoOptions::delay, displays). Both act before the guard: the
// guard is last, whatever is wanted.
//
// Real-time: tick() does not allocate, lock, log or throw; about 0.5 us near a slab (bench_haptics). One
// thread.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "haptics/device.h"
#include "haptics/guard.h"
#include "haptics/held_plane.h"
#include "haptics/passivity.h"
#include "haptics/pen.h"
#include "haptics/proxy.h"
#include "intaglio/event.h"
#include "intaglio/representation.h"
#include "surface/surface.h"

namespace intaglio::haptics {

// Maps the device's workspace to the world: world = origin + scale * device.
struct WorkspaceMap {
  Vec3 origin = Vec3::Zero();  // m, world
  double scale = 1;            // world metres per device metre

  Vec3 to_world(const Vec3& device) const { return origin + scale * device; }
  Vec3 to_device(const Vec3& world) const { return (world - origin) / scale; }
};

enum class HapticMethod {
  potential,  // ours
  plane,      // the paper's, §1.2.4
};

struct ServoOptions {
  Representation representation = Representation::relief;
  HapticMethod method = HapticMethod::potential;
  Spring spring;           // felt on flat ground, per metre of device travel
  double friction = 0.3;   // Coulomb, of pen and surface; method `plane` has none
  double plane_rate = 60;  // Hz, of method `plane`
  bool passivity = true;   // whether the passivity controller acts; the paper has none
  GuardLimits limits;
  WorkspaceMap workspace;
  PenShape pen;
  double thickness = std::numeric_limits<double>::infinity();  // m, of the slab
  double rate = 1000;                                          // Hz
  double velocity_cutoff = 60;  // Hz, of the low-pass on differentiated encoders
  double delay = 0;             // s, rounded to ticks: how late forces reach the guard
  bool displays = true;         // false: the guard gets zero in place of every force
};

// Record of one tick. World frame, SI.
struct ServoSample {
  Vec3 device = Vec3::Zero();           // m, as read, device frame
  Quat orientation = Quat::Identity();  // as read; the identity for devices without orientation
  Vec3 tip = Vec3::Zero();              // m
  Vec3 velocity = Vec3::Zero();         // m/s, filtered, relative to the textured body
  Vec3 proxy = Vec3::Zero();            // m, where the tip is drawn: on the surface while it touches
  Vec3 force = Vec3::Zero();            // N, as sent to the device
  Vec3 wanted = Vec3::Zero();           // N, before the guard
  Vec3 torque = Vec3::Zero();           // N m about the grip, before the guard
  Vec3 n_s = Vec3::UnitY();             // sampled normal
  Vec2 uv = Vec2::Zero();               // at the proxy
  double surface_height = 0;            // m, of the surface at uv over the base plane (<= 0)
  double energy_surplus = 0;            // J, of the passivity observer
  bool touching = false;                // the texture
  bool touching_ball = false;
  std::uint32_t guard_status = 0;
};

class PenServo {
 public:
  // On the rectangle on which the surface is placed.
  PenServo(std::shared_ptr<const surface::Surface> surface, const ServoOptions& options);
  // On a solid of any shape with that texture; method `potential`.
  PenServo(std::shared_ptr<const surface::Surface> surface, std::shared_ptr<const Solid> solid,
           const ServoOptions& options);

  // Reads the device, computes the force and writes it. The scene is at rest and time advances by one period.
  ServoSample tick(Device& device);
  // The same in a moving scene; `time` is on the clock of the snapshot, which must be recent (guard.h).
  ServoSample tick(Device& device, const SceneSnapshot& scene, double time);

  // For the scene: the newest tick, and impulses summed since the start.
  const ServoReport& report() const { return report_; }
  // Makes another servo, ticked at the same poses, say what the pen meets: report() is then its report, but
  // for `felt` and the guard's status. For a hand that is given another force than the contact's: of another
  // solid, late, or none. Before the first tick; costs as much as a second servo.
  void set_contact(PenServo contact) { contact_ = std::make_unique<PenServo>(std::move(contact)); }
  const ServoOptions& options() const { return options_; }
  // Work of the texture on the hand since the start, J.
  double work_on_hand() const { return passivity_.work_on_hand(); }
  void rearm();
  // Zeroes the device's force.
  void release(Device& device) { device.write(guard_.release()); }

 private:
  // The pen of this tick, and its motion relative to the textured body in that body's frame. m, m/s.
  struct TickMotion {
    Pose body;  // of the textured body, in the world, now
    PenPose pen, world_pen;
    Vec3 displacement = Vec3::Zero(), velocity = Vec3::Zero();
  };
  // In the body's frame.
  struct TipContact {
    bool touching;
    Vec3 force, normal, proxy;
    double energy;
  };

  bool read(Device& device, const SceneSnapshot& scene, double time, TickMotion& motion);
  TipContact touch(const TickMotion& motion);
  Vec3 touch_balls(const TickMotion& motion, const SceneSnapshot& scene, Wrench& wrench);
  void fill_sample(const TickMotion& motion, const TipContact& touch, ServoSample& sample) const;
  // The wrench that reaches the guard: now's, an earlier one, or none.
  Wrench displayed(const Wrench& now);
  void tick_contact(Device& device, const SceneSnapshot& scene, double time);
  GuardedForce send(Device& device, const Wrench& wanted, const SceneSnapshot& scene, double time,
                    ServoSample& sample);
  void update_report(const Wrench& about_body, const ServoSample& sample, double time);
  ServoSample reject_reading(Device& device, double time);

  std::shared_ptr<const surface::Surface> surface_;
  std::shared_ptr<const Solid> solid_;
  ServoOptions options_;
  ContactSprings stiffness_;  // in the world
  Spring spring_;             // in the world
  Proxy proxy_;
  HeldPlane plane_;
  PassivityController passivity_;
  Guard guard_;
  ServoReport report_;
  SceneSnapshot at_rest_;
  Vec3 device_tip_ = Vec3::Zero();  // m, device frame
  Quat device_orientation_ = Quat::Identity();
  Vec3 last_tip_ = Vec3::Zero();  // m, tip in the body's frame
  Vec3 velocity_ = Vec3::Zero();  // m/s, body's frame
  double time_ = 0, filter_keep_ = 0;
  bool started_ = false;
  std::vector<Wrench> late_;  // a ring of `delay` ticks; sized at construction
  std::size_t next_late_ = 0;
  std::unique_ptr<PenServo> contact_;  // absent: this servo describes the contact itself
  EchoDevice echo_;                    // of the contact's
};

}  // namespace intaglio::haptics
