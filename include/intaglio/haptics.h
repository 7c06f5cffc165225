// Touch: a device, a surface, and a guard that cannot be left out.
//
//   auto pen = intaglio::open_vrpn("Phantom0@localhost").value();        // vrpn.h, or Device::custom()
//   auto touch = intaglio::ServoLoop::create(pen, {.surface = wall, .stiffness = 600}).value();
//   touch.start();                                        // 1 kHz, on a thread of its own
//   while (running) {                                     // your loop; examples/touch_a_wall.cpp
//     world.step();
//     touch.publish({.balls = {{world.pose(ball).position, world.velocity(ball), 0.05}}});
//     world.push(ball, touch.take_ball_impulse(0));
//   }
//
// The surface is sampled in every tick and the force comes from a stored energy, so that no texture can give
// energy to the hand. Every force goes through a guard: bounded force and slew rate, a ramp-in of half a
// second, the motors' long-run limit, and zero force within 21 ms when the scene, the device or the loop
// falls silent, the hand is too fast, or a value is not a number. A fault stays until rearm().
//
// World frame, SI. The loop and your thread exchange latest values; neither waits for the other. publish() is
// also the heartbeat: call it at least every 20 ms, or the guard lets go. docs/haptics.md has the bounds on
// stiffness.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/representation.h"
#include "intaglio/surface.h"
#include "intaglio/vec.h"

namespace intaglio {

// A driver of your own. Its functions are called by the servo thread: no allocation, lock or exception. They
// are given guarded forces only.
class DeviceDriver {
 public:
  virtual ~DeviceDriver() = default;
  virtual Vec3 position() = 0;  // m, of the tip, in the device's workspace
  // N, and N m about the grip, on the hand until the next call; torque is zero unless
  // GuardLimits::peak_torque is set.
  virtual void set_force(const Vec3& newtons, const Vec3& torque) = 0;
  virtual std::optional<Quat> orientation() { return std::nullopt; }  // from upright, where known
  virtual double silent_for() const { return 0; }                     // s since the device was last heard of
};

struct Waypoint {
  double time = 0;               // s
  Vec3 position = Vec3::Zero();  // m, of the tip, device workspace
};

// A haptic device. A handle; one ServoLoop at a time uses it.
class Device {
 public:
  static Device custom(std::shared_ptr<DeviceDriver> driver);
  // A PHANToM Desktop in a simulated hand that follows a path: for tests and studies without a device. `path`
  // is ordered in time and not empty. Its time is that of the ticks.
  static Device simulated(std::vector<Waypoint> path);

  struct Impl;  // of the library
  explicit Device(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

// Limits that the guard enforces; the defaults are a PHANToM Desktop's.
struct GuardLimits {
  double peak_force = 7.9;         // N
  double continuous_force = 1.75;  // N, in the long run
  double thermal_time = 30;        // s, of the running mean of force squared
  double slew_rate = 2000;         // N/s
  double ramp_in = 0.5;            // s from arming to full force; at least 0.5 whatever is asked for
  double peak_torque = 0;          // N m; 0: no torque is sent
  double continuous_torque = 0;    // N m
  double torque_slew_rate = 100;   // N m/s
  double velocity_limit = 1.5;     // m/s, of the device's tip
  double jump_limit = 0.05;        // m between two ticks
};

// Bits of TouchReport::guard.
namespace guard_bits {
inline constexpr std::uint32_t clamped = 1u << 0;            // larger than is allowed now
inline constexpr std::uint32_t slewed = 1u << 1;             // changed faster than the slew rate
inline constexpr std::uint32_t ramping = 1u << 2;            // within the ramp-in
inline constexpr std::uint32_t fault = 1u << 3;              // latched: zero force until rearm()
inline constexpr std::uint32_t thermally_limited = 1u << 4;  // clamped below the peak: the motors are warm
inline constexpr std::uint32_t hand_too_fast = 1u << 5;      // over the velocity limit: force goes to zero
inline constexpr std::uint32_t not_a_number = 1u << 6;       // and what latched the fault
inline constexpr std::uint32_t scene_stalled = 1u << 7;
inline constexpr std::uint32_t link_lost = 1u << 8;
inline constexpr std::uint32_t loop_stalled = 1u << 9;
inline constexpr std::uint32_t jumped = 1u << 10;
}  // namespace guard_bits

enum class HapticMethod {
  potential,  // ours
  plane,      // the paper's: one plane per picture, Eq. 1.3
};

// The pen in the hand.
struct PenShape {
  double length = 0.15;                  // m, tip to end
  double radius = 0.005;                 // m, of the shaft
  double tip_radius = 0.001;             // m: the tip feels the relief averaged over its diameter
  double grip = 0.06;                    // m from the tip: torque is about there
  double shaft_stiffness = 0;            // N/m per metre of shaft that touches; 0: only the tip does
  Vec3 direction = Vec3(0.25, 1, 0.35);  // from the tip up the shaft, where the device knows no orientation
};

struct TouchOptions {
  Surface surface;         // a rectangle
  double stiffness = 600;  // N/m, felt on flat ground
  double damping = 1;      // N s/m
  double friction = 0.3;   // Coulomb
  Representation representation = Representation::relief;
  HapticMethod method = HapticMethod::potential;
  double rate = 1000;                    // Hz: 1000, 4000 or 8000
  Vec3 workspace_origin = Vec3::Zero();  // m, where the device's origin is in the world
  double workspace_scale = 1;            // world metres per device metre
  PenShape pen = {};
  GuardLimits limits = {};
  double thickness = std::numeric_limits<double>::infinity();  // m, of the slab below the texture
};

inline constexpr std::size_t max_balls = 32;

struct TouchBall {
  Vec3 position = Vec3::Zero();  // m
  Vec3 velocity = Vec3::Zero();  // m/s
  double radius = 0;             // m
};

// The state that your loop publishes in each of its steps.
struct TouchScene {
  std::vector<TouchBall> balls = {};  // at most max_balls are felt
  // Where a textured body has carried the surface, relative to the surface's own pose, and how fast it moves.
  Pose surface_pose = {};
  Vec3 surface_velocity = Vec3::Zero();          // m/s
  Vec3 surface_angular_velocity = Vec3::Zero();  // rad/s
};

// The newest tick.
struct TouchReport {
  std::uint64_t ticks = 0;
  double time = 0;                // s, on the loop's clock
  Vec3 tip = Vec3::Zero();        // m, where the device is
  Vec3 shown_tip = Vec3::Zero();  // m, where to draw it: on the surface while it touches
  Vec3 force = Vec3::Zero();      // N, on the hand
  bool touching = false;
  std::uint32_t guard = 0;  // guard_bits
};

struct TouchTiming {
  double worst_wake_up = 0, p99_wake_up = 0;  // s, how late ticks began
  double worst_compute = 0, p99_compute = 0;  // s, how long they took, device included
  std::uint64_t skipped_ticks = 0;            // after one that was late
  std::string priority;                       // how the thread was scheduled, one line
};

// The servo loop. Call its functions from one thread. The loop's own thread neither allocates nor locks, and
// runs SCHED_FIFO where it may.
class ServoLoop {
 public:
  // Errors: options out of range. The device's force stays zero until start().
  static Result<ServoLoop> create(const Device& device, const TouchOptions& options);
  ServoLoop(ServoLoop&&) noexcept;
  ServoLoop& operator=(ServoLoop&&) noexcept;
  ~ServoLoop();  // lets go of the hand

  void start();
  void stop();   // lets go of the hand and joins the thread
  void rearm();  // clears a fault; force comes back over the ramp-in

  void publish(const TouchScene& scene = {});
  TouchReport report();
  // The impulse on ball k since the last call, N s.
  Vec3 take_ball_impulse(std::size_t k);
  // The same on the textured body; `angular` receives the angular impulse about its pose's position, N m s.
  Vec3 take_surface_impulse(Vec3* angular = nullptr);
  TouchTiming timing() const;

  // One tick in the calling thread instead of start(), in simulated time: offline, and deterministic.
  TouchReport tick(const TouchScene& scene = {});

 private:
  struct Impl;
  explicit ServoLoop(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace intaglio
