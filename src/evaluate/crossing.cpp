#include "evaluate/crossing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/portable_math.h"
#include "evaluate/cpu_timer.h"
#include "evaluate/led_hand.h"
#include "evaluate/reference_motion.h"
#include "haptics/device.h"
#include "haptics/servo.h"
#include "scene/voices/voices.h"
#include "scene/world.h"
#include "session/scene_loop.h"

namespace intaglio::evaluate {

namespace {

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

// Contacts of one probe with the floor as events.
class TouchEvents {
 public:
  TouchEvents(BodyId body, const surface::Placement& place, double rate)
      : body_(body), place_(place), rate_(rate) {}

  // A step that ends at `time`; world frame.
  void add(double time, const std::vector<TouchPoint>& points, const BodyState& state) {
    const Vec3 n = place_.n();
    const auto push = [&](const TouchPoint& at, ContactPhase phase) {
      ContactEvent event;
      event.time = time;
      event.body = body_;
      event.phase = phase;
      event.point = at.point;
      event.uv = place_.uv(place_.to_local(at.point));
      event.n_g = n;
      event.n_s = at.normal;
      event.v_t = state.velocity - state.velocity.dot(n) * n;
      const Vec3 spin = state.angular_velocity.cross(at.point - state.pose.position);
      event.spin = spin - spin.dot(n) * n;
      event.impulse = at.impulse;
      event.duration = 1 / rate_;
      event.body_pose = state.pose;
      events_.push_back(event);
    };
    for (const TouchPoint& at : points) push(at, touches_ ? ContactPhase::persist : ContactPhase::begin);
    if (points.empty() && touches_) push({last_, n, Vec3::Zero()}, ContactPhase::end);
    touches_ = !points.empty();
    if (touches_) last_ = points.front().point;
  }
  const std::vector<ContactEvent>& events() const { return events_; }

 private:
  BodyId body_;
  surface::Placement place_;
  double rate_;
  bool touches_ = false;
  Vec3 last_ = Vec3::Zero();
  std::vector<ContactEvent> events_;
};

// The reference sounds like a mesh: by the impulses of its contacts.
const Candidate& sounding_reference() {
  return candidates()[std::size_t(Kind::mesh_512)];
}

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
  const double start = cpu_seconds();
  synthesizer.render(out.sound);
  out.sound_cost = (cpu_seconds() - start) / (double(out.sound.size()) / 64);
}

// The servo of a candidate's pen, and the link that makes its contacts.
struct Pen {
  session::PenLink link;
  haptics::PenServo servo;

  Pen(const Subject& subject, const Candidate& candidate, const scene::Scene& scene)
      : link(scene, subject.surface(candidate), candidate.representation),
        servo(make(subject, candidate, scene, link)) {}

 private:
  static haptics::PenServo make(const Subject& subject, const Candidate& candidate, const scene::Scene& scene,
                                const session::PenLink& link) {
    if (candidate.mesh_cells == 0) return link.make_servo();
    const scene::SceneSurface& surface = subject.surface(candidate);
    return {surface.surface, std::make_shared<MeshSolid>(subject.mesh(candidate), scene.surface.thickness),
            session::pen_options(scene, surface.material)};
  }
};

}  // namespace

double loop_energy(const Subject& subject, const Candidate& candidate, const Vec2& centre, double radius) {
  const scene::Scene scene = subject.scene(candidate);
  const surface::Placement& place = subject.surface(candidate).surface->placement();
  Pen pen(subject, candidate, scene);
  const bool is_relief = candidate.representation == Representation::relief;
  const double z = (is_relief ? subject.reference().mean() : 0) - 0.001;
  // A device that is where it is led.
  class Led : public haptics::Device {
   public:
    Vec3 at = Vec3::Zero(), force = Vec3::Zero();
    Vec3 read() override { return at; }
    void write(const haptics::GuardedForce& guarded) override { force = guarded.newtons(); }
  } device;
  constexpr int rounds = 5;
  constexpr double rate = 1000;
  double work = 0;
  for (std::int64_t k = 0; k < std::int64_t(rounds * rate); ++k) {
    const double time = double(k) / rate;
    const auto turn = elementary::sin_cos(2 * std::numbers::pi * time);
    const Vec2 p = centre + radius * Vec2(turn.cos, turn.sin);
    const Vec3 before = device.at, held = device.force;
    device.at = scene.pen->workspace.to_device(place.to_world({p.x(), p.y(), z}));
    if (time >= 1) work += held.dot(device.at - before);
    haptics::SceneSnapshot snapshot;
    snapshot.time = time;
    pen.servo.tick(device, snapshot, time);
  }
  return work / (rounds - 1);
}

Crossing stroke(const Subject& subject, const Candidate& candidate, const StrokeOptions& options) {
  const scene::Scene scene = subject.scene(candidate);
  const surface::Placement& place = subject.surface(candidate).surface->placement();
  const haptics::WorkspaceMap& map = scene.pen->workspace;
  Pen pen(subject, candidate, scene);
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
    const double start = cpu_seconds();
    const haptics::ServoSample sample = pen.servo.tick(hand, snapshot, time);
    cost += cpu_seconds() - start;
    if (time >= plan.ramp) hand.advance(1 / rate);
    pen.link.emit_contact(pen.servo.report(), double(k + 1) / rate, 1 / rate,
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
  const surface::Placement& place = subject.surface(ours).surface->placement();
  TouchEvents events(subject.scene(ours).pen_id(), place, reference_rate);
  Vec3 before = place.to_world(local(hand.position()));
  // Its force holds from one step to the next, as a device's does.
  for (std::int64_t k = std::int64_t(plan.ramp * reference_rate);
       k < std::int64_t(plan.seconds() * reference_rate); ++k) {
    const double time = double(k) / reference_rate;
    hand.lead_to(led(time));
    const Vec3 force = tip.follow(local(hand.position()));
    hand.advance(device(force), 1 / reference_rate);
    BodyState state;
    state.pose.position = place.to_world(tip.tip());
    state.velocity = (state.pose.position - before) * reference_rate;
    before = state.pose.position;
    std::vector<TouchPoint> touch;
    if (tip.touches()) {
      const Vec2 slope = subject.reference().rest_on(tip.tip().head<2>(), subject.tip_radius).slope;
      touch.push_back({state.pose.position,
                       place.direction_to_world(Vec3(-slope.x(), -slope.y(), 1).normalized()),
                       place.direction_to_world(force) / reference_rate});
    }
    events.add(time + 1 / reference_rate, touch, state);
    if (time < plan.ramp + plan.rest) continue;
    if (out.place.empty()) out.start = time;
    out.place.push_back(tip.tip());
    out.force.push_back(force);
    out.touching.push_back(tip.touches());
  }
  make_sound(subject, sounding_reference(), events.events(), plan.seconds() + 0.2, out);
  return out;
}

namespace {

// A world with one ball, whichever engine moves it.
class BallWorld {
 public:
  BallWorld(const Subject& subject, const Candidate& candidate, const scene::Scene& scene) {
    const scene::SceneSurface& surface = subject.surface(candidate);
    if (candidate.mesh_cells > 0) {
      mesh_.emplace(subject.mesh(candidate), surface.material, contact::Sphere{subject.ball_radius()},
                    scene.balls[0].material, scene.physics.rate);
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
  Vec3 velocity() const { return mesh_ ? mesh_->state().velocity : world_->world().drawn_velocity(1); }
  // Those of the last step, which ended at `time`.
  std::vector<ContactEvent> events(double time, TouchEvents& of_mesh) const {
    if (!mesh_) return {world_->world().events().begin(), world_->world().events().end()};
    const std::size_t before = of_mesh.events().size();
    of_mesh.add(time, mesh_->touches(), mesh_->state());
    return {of_mesh.events().begin() + std::ptrdiff_t(before), of_mesh.events().end()};
  }

 private:
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
  ball.put({{{options.from.x(), options.from.y(), z + radius + options.drop}, Quat::Identity()},
            velocity,
            Vec3::UnitZ().cross(velocity) / radius});
  ReferenceRoll out;
  out.crossing = {.probe = Probe::ball,
                  .is_strike = options.drop > 0,
                  .radius = radius,
                  .rate = reference_rate,
                  .start = 1 / reference_rate};
  out.states.push_back(ball.state());
  const surface::Placement& place = subject.surface(ours).surface->placement();
  const auto in_world = [&](const BodyState& local) {
    return BodyState{{place.to_world(local.pose.position), local.pose.orientation},
                     place.direction_to_world(local.velocity),
                     place.direction_to_world(local.angular_velocity)};
  };
  TouchEvents events(1, place, reference_rate);
  for (std::int64_t k = 0; k < std::int64_t(options.seconds * reference_rate); ++k) {
    const Vec3 before = ball.state().velocity;
    ball.step();
    const Vec3& at = ball.state().pose.position;
    if (!place.covers(at, -radius)) break;
    std::vector<TouchPoint> touches = ball.touch_points();
    for (TouchPoint& touch : touches)
      touch = {place.to_world(touch.point), place.direction_to_world(touch.normal),
               place.direction_to_world(touch.impulse)};
    events.add(double(k + 1) / reference_rate, touches, in_world(ball.state()));
    out.states.push_back(ball.state());
    out.crossing.place.push_back(at - Vec3(0, 0, radius));
    out.crossing.touching.push_back(ball.touches());
    out.crossing.acceleration.push_back(reference_rate * (ball.state().velocity - before));
  }
  make_sound(subject, sounding_reference(), events.events(),
             double(out.crossing.place.size()) / reference_rate + 0.2, out.crossing);
  return out;
}

Crossing roll(const Subject& subject, const Candidate& candidate, const RollOptions& options,
              const ReferenceRoll& reference) {
  const scene::Scene scene = subject.scene(candidate);
  const surface::Placement& place = subject.surface(candidate).surface->placement();
  const double radius = subject.ball_radius(), rate = scene.physics.rate;
  BallWorld world(subject, candidate, scene);
  TouchEvents of_mesh(1, place, rate);
  // Normal maps and flat floors are at the base plane.
  const bool is_relief = candidate.representation == Representation::relief;
  const auto restart_from = [&](BodyState state) {
    if (!is_relief) {
      state.pose.position.z() = radius + options.drop;
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
    if (k % every == 0) {
      const BodyState& from = reference.states[std::size_t(k) * ratio];
      if (k > 0) out.strayed.push_back(place.to_local(world.position()) - from.pose.position);
      restart_from(from);
    }
    const Vec3 before = world.velocity();
    const double start = cpu_seconds();
    world.step();
    cost += cpu_seconds() - start;
    out.acceleration.push_back(rate * place.direction_to_local(world.velocity() - before));
    out.place.push_back(place.to_local(world.position()) - Vec3(0, 0, radius));
    bool touches = false;
    for (const ContactEvent& event : world.events(double(k + 1) / rate, of_mesh)) {
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
