#include "evaluate/crossing.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "evaluate/led_hand.h"
#include "evaluate/reference_motion.h"
#include "haptics/device.h"
#include "haptics/servo.h"
#include "scene/voices/voices.h"
#include "scene/world.h"
#include "session/scene_loop.h"

namespace intaglio::evaluate {

namespace {

double thread_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// A LedHand that holds a device.
class HandDevice : public haptics::Device {
 public:
  HandDevice(const Vec3& at, double load) : hand_(at, load) {}

  Vec3 read() override {
    constexpr double resolution = 2.3e-5;  // m, of a PHANToM's encoders
    return (hand_.position() / resolution).array().round().matrix() * resolution;
  }
  void write(const haptics::GuardedForce& force) override { force_ = force.newtons(); }
  void lead_to(const Vec3& place) { hand_.lead_to(place); }
  void advance(double dt) { hand_.advance(force_, dt); }

 private:
  LedHand hand_;
  Vec3 force_ = Vec3::Zero();
};

// When the hand of a stroke is where: the guard ramps its force in, then the hand goes down, then along.
struct StrokePlan {
  static constexpr double ramp = 0.6, rest = 0.3;  // s
  const StrokeOptions& options;
  double top;  // m, from where it goes down

  double length() const { return (options.to - options.from).norm(); }
  double seconds() const { return ramp + rest + length() / options.speed; }
  Vec2 place(double time) const {
    const double along = std::clamp((time - ramp - rest) * options.speed / length(), 0.0, 1.0);
    return options.from + along * (options.to - options.from);
  }
};

// The sound of events, until `seconds`.
void make_sound(const Subject& subject, const Candidate& candidate, const std::vector<ContactEvent>& events,
                double seconds, Crossing& out) {
  scene::Scene scene = subject.scene(candidate);
  sound::SynthesizerOptions options = scene::synthesizer_options(scene);
  if (candidate.mesh_cells > 0) options.meso = sound::MesoSource::engine_impulses;
  sound::Synthesizer synthesizer(options, subject.voices(candidate));
  for (const ContactEvent& event : events) synthesizer.push(event);
  out.sample_rate = options.sample_rate;
  out.sound.resize(std::size_t(seconds * options.sample_rate));
  const double start = thread_seconds();
  synthesizer.render(out.sound);
  out.sound_cost = (thread_seconds() - start) / (double(out.sound.size()) / 64);
}

}  // namespace

Crossing stroke(const Subject& subject, const Candidate& candidate, const StrokeOptions& options) {
  const scene::Scene scene = subject.scene(candidate);
  const scene::SceneSurface& surface = subject.surface(candidate);
  const surface::Placement& place = surface.surface->placement();
  const haptics::WorkspaceMap& map = scene.pen->workspace;
  session::PenLink link(scene, surface, candidate.representation);
  haptics::PenServo servo =
      candidate.mesh_cells > 0
          ? haptics::PenServo(surface.surface,
                              std::make_shared<MeshSolid>(subject.mesh(candidate), scene.surface.thickness),
                              session::pen_options(scene, surface.material))
          : link.make_servo();
  const StrokePlan plan{options, 0.002};
  const auto device_place = [&](double time) {
    const Vec2 p = plan.place(time);
    return map.to_device(place.to_world({p.x(), p.y(), plan.top}));
  };
  constexpr double rate = 1000;
  HandDevice hand(device_place(0), options.load);
  Crossing out{.probe = Probe::pen, .radius = subject.tip_radius, .rate = rate};
  std::vector<ContactEvent> events;
  double cost = 0;
  const auto ticks = std::int64_t(plan.seconds() * rate);
  for (std::int64_t k = 0; k < ticks; ++k) {
    const double time = double(k) / rate;
    haptics::SceneSnapshot snapshot;
    snapshot.time = time;
    hand.lead_to(device_place(time));
    const double start = thread_seconds();
    const haptics::ServoSample sample = servo.tick(hand, snapshot, time);
    cost += thread_seconds() - start;
    if (time >= plan.ramp) hand.advance(1 / rate);
    link.emit_contact(servo.report(), double(k + 1) / rate, 1 / rate,
                      [&](const ContactEvent& event) { events.push_back(event); });
    if (time < plan.ramp + plan.rest) continue;
    if (out.place.empty()) out.start = time;
    out.place.push_back(place.to_local(sample.proxy));
    out.force.push_back(place.direction_to_local(sample.force));
    out.touching.push_back(sample.touching);
  }
  out.touch_cost = cost / double(ticks);
  make_sound(subject, candidate, events, plan.seconds() + 0.2, out);
  return out;
}

Crossing reference_stroke(const Subject& subject, const StrokeOptions& options) {
  const Candidate& ours = candidates()[std::size_t(Kind::relief)];
  const haptics::ServoOptions pen = session::pen_options(subject.scene(ours), subject.surface(ours).material);
  ReferencePen tip(subject.reference(), subject.tip_radius, pen.spring.stiffness, pen.friction);
  const StrokePlan plan{options, 0.002};
  const auto device = [](const Vec3& local) { return Vec3(local.x(), local.z(), -local.y()); };
  const auto local = [](const Vec3& at) { return Vec3(at.x(), -at.z(), at.y()); };
  const auto led = [&](double time) {
    const Vec2 p = plan.place(time);
    return device({p.x(), p.y(), plan.top});
  };
  LedHand hand(led(0), options.load);
  Crossing out{.probe = Probe::pen, .radius = subject.tip_radius, .rate = reference_rate};
  // Its force holds from one step to the next, as a device's does.
  for (std::int64_t k = std::int64_t(plan.ramp * reference_rate);
       k < std::int64_t(plan.seconds() * reference_rate); ++k) {
    const double time = double(k) / reference_rate;
    hand.lead_to(led(time));
    const Vec3 force = tip.follow(local(hand.position()));
    hand.advance(device(force), 1 / reference_rate);
    if (time < plan.ramp + plan.rest) continue;
    if (out.place.empty()) out.start = time;
    out.place.push_back(tip.tip());
    out.force.push_back(force);
    out.touching.push_back(tip.touches());
  }
  return out;
}

namespace {

// A world with one ball, whichever engine moves it.
class BallWorld {
 public:
  BallWorld(const Subject& subject, const Candidate& candidate, const scene::Scene& scene)
      : radius_(subject.ball_radius()) {
    const scene::SceneSurface& surface = subject.surface(candidate);
    if (candidate.mesh_cells > 0) {
      mesh_.emplace(subject.mesh(candidate), surface.material, radius_, scene.balls[0].material,
                    scene.physics.rate);
    } else {
      world_.emplace(scene, surface, candidate.representation);
    }
  }
  void put(const BodyState& state) {
    if (mesh_) return mesh_->put(state);
    world_->world().put(1, state.pose, state.velocity, state.angular_velocity);
  }
  void step() {
    if (mesh_) return mesh_->step();
    world_->step();
  }
  Vec3 position() const { return mesh_ ? mesh_->state().pose.position : world_->pose(0).position; }
  std::span<const ContactEvent> events() const { return mesh_ ? mesh_->events() : world_->world().events(); }

 private:
  double radius_;
  std::optional<MeshWorld> mesh_;
  std::optional<scene::SceneWorld> world_;
};

}  // namespace

ReferenceRoll reference_roll(const Subject& subject, const RollOptions& options) {
  const double radius = subject.ball_radius();
  const Candidate& ours = candidates()[std::size_t(Kind::relief)];
  ReferenceBall ball(subject.reference(), radius, subject.scene(ours).balls[0].material,
                     subject.surface(ours).material);
  const double z = subject.reference().rest_on(options.from, radius).z;
  const Vec3 velocity(options.velocity.x(), options.velocity.y(), 0);
  ball.put({{{options.from.x(), options.from.y(), z + radius}, Quat::Identity()},
            velocity,
            Vec3::UnitZ().cross(velocity) / radius});
  ReferenceRoll out;
  out.crossing = {
      .probe = Probe::ball, .radius = radius, .rate = reference_rate, .start = 1 / reference_rate};
  out.states.push_back(ball.state());
  for (std::int64_t k = 0; k < std::int64_t(options.seconds * reference_rate); ++k) {
    ball.step();
    const Vec3& at = ball.state().pose.position;
    if (!surface::Placement(Vec3::Zero(), Quat::Identity(), subject.options().size, subject.options().size)
             .covers(at, -radius))
      break;
    out.states.push_back(ball.state());
    out.crossing.place.push_back(at - Vec3(0, 0, radius));
    out.crossing.touching.push_back(ball.touches());
  }
  return out;
}

Crossing roll(const Subject& subject, const Candidate& candidate, const RollOptions& options,
              const ReferenceRoll& reference) {
  const scene::Scene scene = subject.scene(candidate);
  const surface::Placement& place = subject.surface(candidate).surface->placement();
  const double radius = subject.ball_radius(), rate = scene.physics.rate;
  BallWorld world(subject, candidate, scene);
  // Normal maps and flat floors are at the base plane.
  const bool is_relief = candidate.representation == Representation::relief;
  const auto restart_from = [&](BodyState state) {
    if (!is_relief) {
      state.pose.position.z() = radius;
      state.velocity.z() = 0;
    }
    const Quat frame = Quat(Mat3((Mat3() << place.t(), place.b(), place.n()).finished()));
    world.put({{place.to_world(state.pose.position), (frame * state.pose.orientation).normalized()},
               place.direction_to_world(state.velocity),
               place.direction_to_world(state.angular_velocity)});
  };
  Crossing out{.probe = Probe::ball, .radius = radius, .rate = rate, .start = 1 / rate};
  std::vector<ContactEvent> events;
  double cost = 0;
  const auto every = std::int64_t(std::lround(options.restart * rate));
  const auto ratio = std::size_t(std::lround(reference_rate / rate));
  const std::int64_t steps = std::int64_t(reference.states.size() - 1) / std::int64_t(ratio);
  for (std::int64_t k = 0; k < steps; ++k) {
    if (k % every == 0) restart_from(reference.states[std::size_t(k) * ratio]);
    const double start = thread_seconds();
    world.step();
    cost += thread_seconds() - start;
    out.place.push_back(place.to_local(world.position()) - Vec3(0, 0, radius));
    bool touches = false;
    for (const ContactEvent& event : world.events()) {
      events.push_back(event);
      touches = touches || event.phase != ContactPhase::end;
    }
    out.touching.push_back(touches);
  }
  out.motion_cost = steps > 0 ? cost / double(steps) : 0;
  make_sound(subject, candidate, events, double(out.place.size()) / rate + 0.2, out);
  return out;
}

}  // namespace intaglio::evaluate
