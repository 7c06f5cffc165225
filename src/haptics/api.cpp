#include "haptics/api.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptics/servo_loop.h"
#include "surface/api.h"

namespace intaglio {

namespace {

// A user's driver.
class Driven : public haptics::Device {
 public:
  explicit Driven(std::shared_ptr<DeviceDriver> driver) : driver_(std::move(driver)) {}

  Vec3 read() override {
    orientation_ = driver_->orientation();
    return driver_->position();
  }
  void write(const haptics::GuardedForce& force) override {
    driver_->set_force(force.newtons(), force.newton_metres());
  }
  bool reads_orientation() const override { return orientation_.has_value(); }
  Quat orientation() override { return orientation_.value_or(Quat::Identity()); }
  double silent_for() const override { return driver_->silent_for(); }

 private:
  std::shared_ptr<DeviceDriver> driver_;
  std::optional<Quat> orientation_;
};

// A simulated device that moves from tick to tick.
class Ticking : public haptics::Device {
 public:
  Ticking(std::vector<haptics::Waypoint> path, std::shared_ptr<const double> period)
      : device_({}, {}, std::move(path)), period_(std::move(period)) {}

  Vec3 read() override { return device_.read(); }
  void write(const haptics::GuardedForce& force) override {
    device_.write(force);
    device_.advance(*period_);
  }

 private:
  haptics::SimulatedDevice device_;
  std::shared_ptr<const double> period_;
};

haptics::ServoOptions servo_options(const TouchOptions& from) {
  haptics::ServoOptions options;
  options.representation = from.representation;
  options.method =
      from.method == HapticMethod::plane ? haptics::HapticMethod::plane : haptics::HapticMethod::potential;
  options.spring = {from.stiffness, from.damping};
  options.friction = from.friction;
  options.passivity = from.method == HapticMethod::potential;
  haptics::GuardLimits& limits = options.limits;
  limits.peak_force = from.limits.peak_force;
  limits.continuous_force = from.limits.continuous_force;
  limits.thermal_time = from.limits.thermal_time;
  limits.slew_rate = from.limits.slew_rate;
  limits.ramp_in = from.limits.ramp_in;
  limits.peak_torque = from.limits.peak_torque;
  limits.continuous_torque = from.limits.continuous_torque;
  limits.torque_slew_rate = from.limits.torque_slew_rate;
  limits.velocity_limit = from.limits.velocity_limit;
  limits.jump_limit = from.limits.jump_limit;
  options.workspace = {from.workspace_origin, from.workspace_scale};
  haptics::PenShape& pen = options.pen;
  pen.length = from.pen.length;
  pen.radius = from.pen.radius;
  pen.tip_radius = from.pen.tip_radius;
  pen.grip = from.pen.grip;
  pen.shaft_stiffness = from.pen.shaft_stiffness;
  pen.direction = from.pen.direction;
  options.thickness = from.thickness;
  options.rate = from.rate;
  return options;
}

haptics::SceneSnapshot snapshot_of(const TouchScene& scene) {
  haptics::SceneSnapshot out;
  out.textured = {scene.surface_pose, scene.surface_velocity, scene.surface_angular_velocity};
  out.ball_count = std::min(scene.balls.size(), haptics::max_balls);
  for (std::size_t k = 0; k < out.ball_count; ++k)
    out.balls[k] = {scene.balls[k].position, scene.balls[k].velocity, scene.balls[k].radius};
  return out;
}

TouchReport report_of(const haptics::ServoReport& from) {
  return {from.ticks, from.time, from.tip, from.proxy, from.force, from.touching, from.guard_status};
}

}  // namespace

Device Device::custom(std::shared_ptr<DeviceDriver> driver) {
  auto impl = std::make_shared<Impl>();
  impl->device = std::make_unique<Driven>(std::move(driver));
  return Device(std::move(impl));
}

Device Device::simulated(std::vector<Waypoint> path) {
  std::vector<haptics::Waypoint> points;
  for (const Waypoint& waypoint : path) points.push_back({waypoint.time, waypoint.position});
  auto impl = std::make_shared<Impl>();
  impl->device = std::make_unique<Ticking>(std::move(points), impl->period);
  return Device(std::move(impl));
}

struct ServoLoop::Impl {
  Device device;
  haptics::PenServo offline;
  haptics::ServoLoop loop;
  haptics::ServoReport newest;
  std::array<Vec3, haptics::max_balls> taken{};  // N s, of what balls were given
  Vec3 surface_taken = Vec3::Zero(), surface_angular_taken = Vec3::Zero();
  double time = 0;  // s, of offline ticks
  bool is_live = false;

  Impl(const Device& d, const TouchOptions& options)
      : device(d),
        offline(options.surface.impl().surface, servo_options(options)),
        loop(haptics::PenServo(options.surface.impl().surface, servo_options(options)), *d.impl().device) {
    taken.fill(Vec3::Zero());
  }

  const haptics::ServoReport& update() {
    if (is_live) newest = loop.latest();
    return newest;
  }
};

ServoLoop::ServoLoop(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ServoLoop::ServoLoop(ServoLoop&&) noexcept = default;
ServoLoop& ServoLoop::operator=(ServoLoop&&) noexcept = default;
ServoLoop::~ServoLoop() = default;

Result<ServoLoop> ServoLoop::create(const Device& device, const TouchOptions& options) {
  if (!(options.rate >= 100 && options.rate <= 20'000))
    return fail("TouchOptions::rate", "is not a servo rate", "1000, 4000 or 8000 Hz are usual");
  if (!(options.stiffness >= 0) || !(options.damping >= 0) || !(options.friction >= 0))
    return fail("TouchOptions", "stiffness, damping and friction must be 0 or more");
  if (!(options.workspace_scale > 0)) return fail("TouchOptions::workspace_scale", "is not above 0");
  *device.impl().period = 1 / options.rate;
  return ServoLoop(std::make_unique<Impl>(device, options));
}

void ServoLoop::start() {
  impl_->is_live = true;
  impl_->loop.start();
}
void ServoLoop::stop() {
  impl_->loop.stop();
}
void ServoLoop::rearm() {
  impl_->loop.rearm();
  impl_->offline.rearm();
}

void ServoLoop::publish(const TouchScene& scene) {
  impl_->loop.publish(snapshot_of(scene));
}
TouchReport ServoLoop::report() {
  return report_of(impl_->update());
}

Vec3 ServoLoop::take_ball_impulse(std::size_t k) {
  const Vec3 sum = impl_->update().ball_impulse[k];
  return sum - std::exchange(impl_->taken[k], sum);
}
Vec3 ServoLoop::take_surface_impulse(Vec3* angular) {
  const haptics::ServoReport& now = impl_->update();
  if (angular != nullptr)
    *angular = now.textured_angular_impulse -
               std::exchange(impl_->surface_angular_taken, Vec3(now.textured_angular_impulse));
  return now.textured_impulse - std::exchange(impl_->surface_taken, Vec3(now.textured_impulse));
}

TouchTiming ServoLoop::timing() const {
  const haptics::ServoLoop& loop = impl_->loop;
  return {loop.wake_up().max(),          loop.wake_up().quantile(0.99), loop.compute().max(),
          loop.compute().quantile(0.99), loop.skipped_ticks(),               loop.priority()};
}

TouchReport ServoLoop::tick(const TouchScene& scene) {
  impl_->time += 1 / impl_->offline.options().rate;
  haptics::SceneSnapshot snapshot = snapshot_of(scene);
  snapshot.time = impl_->time;
  impl_->offline.tick(*impl_->device.impl().device, snapshot, impl_->time);
  impl_->newest = impl_->offline.report();
  return report_of(impl_->newest);
}

}  // namespace intaglio
