#include "haptics/servo.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/portable_math.h"
#include "intaglio/representation.h"

namespace intaglio::haptics {

namespace {

SolidOptions solid_options(const ServoOptions& options) {
  return {options.representation, 2 * options.pen.tip_radius, options.thickness};
}

// Normals without a height have no potential: only the paper's plane can display them.
HapticMethod effective_method(const ServoOptions& options, const surface::Surface& surface) {
  const bool normals_only = options.representation == Representation::normal && !surface.has_depth();
  return normals_only ? HapticMethod::plane : options.method;
}

// Sampling a spring adds 1/2 K dx^2 per tick; damping of K T / 2 would dissipate that. Allow twice as much.
PassivityOptions passivity_options(const ContactSprings& stiffness, double rate) {
  PassivityOptions options;
  options.max_damping = stiffness.coupling / rate;
  return options;
}

// Adds damping along the normal, without ever pulling.
Vec3 with_damping(const Vec3& force, const Vec3& normal, const Vec3& velocity, double damping) {
  const double push = force.dot(normal);
  return push > 0 ? Vec3(force + std::max(-push, -damping * normal.dot(velocity)) * normal) : force;
}

}  // namespace

PenServo::PenServo(std::shared_ptr<const surface::Surface> surface, const ServoOptions& options)
    : PenServo(surface, std::make_shared<TexturedSlab>(surface, solid_options(options)), options) {
  options_.method = effective_method(options, *surface_);
}

PenServo::PenServo(std::shared_ptr<const surface::Surface> surface, std::shared_ptr<const Solid> solid,
                   const ServoOptions& options)
    : surface_(std::move(surface)),
      solid_(std::move(solid)),
      options_(options),
      stiffness_(ContactSprings::for_felt_stiffness(options.spring.stiffness /
                                                    (options.workspace.scale * options.workspace.scale))),
      spring_{options.spring.stiffness / (options.workspace.scale * options.workspace.scale),
              options.spring.damping / (options.workspace.scale * options.workspace.scale)},
      plane_(std::min(options.plane_rate, options.rate)),
      passivity_(passivity_options(stiffness_, options.rate)),
      guard_(options.limits),
      filter_keep_(elementary::exp(-2 * std::numbers::pi * options.velocity_cutoff / options.rate)),
      late_(std::size_t(std::lround(std::max(0.0, options.delay) * options.rate))) {
  options_.method = HapticMethod::potential;
  options_.pen.direction.normalize();
}

void PenServo::rearm() {
  guard_.rearm();
  started_ = false;
  if (contact_) contact_->rearm();
}

bool PenServo::read(Device& device, const SceneSnapshot& scene, double time, TickMotion& motion) {
  device_tip_ = device.read();
  const bool turns = device.reads_orientation();
  device_orientation_ = turns ? device.orientation() : Quat::Identity();
  if (!device_tip_.allFinite() || !device_orientation_.coeffs().allFinite() || !std::isfinite(time))
    return false;
  motion.body = scene.textured.extrapolated(time - scene.time);
  motion.world_pen = {options_.workspace.to_world(device_tip_),
                      turns ? Vec3(device_orientation_ * Vec3::UnitY()) : options_.pen.direction};
  motion.pen = {motion.body.to_local(motion.world_pen.tip),
                motion.body.orientation.conjugate() * motion.world_pen.up};
  if (!started_) {
    last_tip_ = motion.pen.tip;
    velocity_.setZero();
    proxy_.reset();
    plane_.reset();
    passivity_.reset();
    passivity_.set_sent(Vec3::Zero());
    std::fill(late_.begin(), late_.end(), Wrench());
  }
  motion.displacement = motion.pen.tip - last_tip_;
  velocity_ = filter_keep_ * velocity_ + (1 - filter_keep_) * options_.rate * motion.displacement;
  motion.velocity = velocity_;
  last_tip_ = motion.pen.tip;
  started_ = true;
  return true;
}

PenServo::TipContact PenServo::touch(const TickMotion& motion) {
  const Vec3& x = motion.pen.tip;
  if (options_.method == HapticMethod::plane) {
    const auto c =
        plane_.move(*surface_, options_.representation, x, motion.velocity, spring_, 1 / options_.rate);
    return {c.touching, c.force, c.normal, c.proxy, c.energy};
  }
  const auto c = proxy_.move(*solid_, x, stiffness_, options_.friction);
  if (!c.touching) return {false, Vec3::Zero(), c.normal, x, 0};
  return {true, with_damping(c.force, c.normal, motion.velocity, spring_.damping), c.normal,
          proxy_.position(), c.energy};
}

Vec3 PenServo::touch_balls(const TickMotion& motion, const SceneSnapshot& scene, Wrench& wrench) {
  Vec3 sum = Vec3::Zero();
  const Vec3 tip_velocity = motion.body.orientation * motion.velocity;
  for (std::size_t k = 0; k < std::min(scene.ball_count, max_balls); ++k) {
    SceneBall ball = scene.balls[k];
    ball.position += (time_ - scene.time) * ball.velocity;
    const BallContact contact =
        touch_ball(options_.pen, motion.world_pen, tip_velocity, ball, spring_.stiffness, spring_.damping);
    if (!contact.touching) continue;
    report_.ball_impulse[k] -= contact.force / options_.rate;
    wrench += Wrench::of(contact.force, contact.point, motion.world_pen.at(options_.pen.grip));
    sum += contact.force;
  }
  return sum;
}

void PenServo::fill_sample(const TickMotion& motion, const TipContact& touch, ServoSample& sample) const {
  const surface::Placement& place = surface_->placement();
  sample.tip = motion.world_pen.tip;
  sample.velocity = motion.body.orientation * motion.velocity;
  sample.proxy = motion.body.to_world(touch.proxy);
  sample.touching = touch.touching;
  sample.uv = place.uv(place.to_local(touch.proxy));
  const bool flat = options_.representation == Representation::flat;
  sample.n_s = motion.body.orientation * (flat ? place.n() : surface_->world_normal(sample.uv));
  if (options_.representation == Representation::relief) sample.surface_height = -surface_->depth(sample.uv);
}

Wrench PenServo::displayed(const Wrench& now) {
  if (!options_.displays) return {};
  if (late_.empty()) return now;
  const Wrench then = std::exchange(late_[next_late_], now);
  next_late_ = (next_late_ + 1) % late_.size();
  return then;
}

void PenServo::tick_contact(Device& device, const SceneSnapshot& scene, double time) {
  echo_.set(device_tip_, device.reads_orientation() ? std::optional(device_orientation_) : std::nullopt,
            device.silent_for());
  contact_->tick(echo_, scene, time);
  const Vec3 felt = report_.felt;
  const std::uint32_t status = guard_.status();
  report_ = contact_->report();
  report_.felt = felt;
  report_.guard_status = status;
}

GuardedForce PenServo::send(Device& device, const Wrench& wanted, const SceneSnapshot& scene, double time,
                            ServoSample& sample) {
  GuardInput input;
  input.wanted = wanted;
  input.tip = device_tip_;
  input.time = time;
  input.scene_time = scene.time;
  input.link_time = time - device.silent_for();
  const GuardedForce guarded = guard_.pass(input);
  device.write(guarded);
  sample.device = device_tip_;
  sample.orientation = device_orientation_;
  sample.force = guarded.newtons();
  sample.wanted = wanted.force;
  sample.torque = wanted.torque;
  sample.guard_status = guard_.status();
  return guarded;
}

ServoSample PenServo::reject_reading(Device& device, double time) {
  // The guard sees the bad number, so that it latches; the filters do not, so that rearm() finds them sound.
  started_ = false;
  ServoSample sample;
  SceneSnapshot scene;
  scene.time = time;
  Wrench bad;
  bad.force.setConstant(std::numeric_limits<double>::quiet_NaN());
  send(device, bad, scene, time, sample);
  if (contact_) tick_contact(device, scene, time);
  return sample;
}

void PenServo::update_report(const Wrench& about_body, const ServoSample& sample, double time) {
  report_.time = time;
  report_.tip = sample.tip;
  report_.proxy = sample.proxy;
  report_.velocity = sample.velocity;
  report_.force = report_.felt = sample.force;
  report_.touching = sample.touching;
  report_.guard_status = sample.guard_status;
  ++report_.ticks;
  report_.textured_impulse -= about_body.force / options_.rate;
  report_.textured_angular_impulse -= about_body.torque / options_.rate;
}

ServoSample PenServo::tick(Device& device) {
  time_ += 1 / options_.rate;
  at_rest_.time = time_;
  return tick(device, at_rest_, time_);
}

ServoSample PenServo::tick(Device& device, const SceneSnapshot& scene, double time) {
  time_ = time;
  TickMotion motion;
  if (!read(device, scene, time, motion)) return reject_reading(device, time);
  ServoSample sample;
  TipContact touch = this->touch(motion);
  passivity_.observe(motion.displacement, touch.energy);
  if (options_.passivity && touch.touching)
    touch.force += passivity_.damping_force(motion.displacement, 1 / options_.rate);
  fill_sample(motion, touch, sample);
  sample.energy_surplus = passivity_.surplus();

  const Vec3 tip_force = motion.body.orientation * touch.force;
  const Vec3 grip = motion.world_pen.at(options_.pen.grip);
  Wrench wrench = Wrench::of(tip_force, motion.world_pen.tip, grip);
  Wrench shaft;
  if (options_.pen.shaft_stiffness > 0) {
    const Wrench local = shaft_wrench(*solid_, options_.pen, motion.pen);
    shaft = {motion.body.orientation * local.force, motion.body.orientation * local.torque};
    wrench += shaft;
  }
  const Vec3 ball_force = touch_balls(motion, scene, wrench);
  sample.touching_ball = ball_force != Vec3::Zero();

  const double scale = options_.workspace.scale;
  const Wrench wanted = displayed({scale * wrench.force, wrench.torque});
  const GuardedForce guarded = send(device, wanted, scene, time, sample);
  // Attributes the guard's reduction to the texture's force. The controller answers for the texture: a force
  // that is late or withheld is a study's matter, and limited by the guard.
  const bool is_true = options_.displays && late_.empty();
  const Vec3 sent = guarded.newtons() / scale - ball_force - shaft.force;
  passivity_.set_sent(is_true ? Vec3(motion.body.orientation.conjugate() * sent) : touch.force);
  const bool reduced = (sample.guard_status & (guard_status::ramping | guard_status::fault)) != 0;
  if (reduced) passivity_.reset(touch.energy);
  Wrench about_body = Wrench::of(tip_force, sample.proxy, motion.body.position);
  about_body += shaft.about(motion.body.position - grip);
  update_report(about_body, sample, time);
  if (contact_) tick_contact(device, scene, time);
  return sample;
}

}  // namespace intaglio::haptics
