#include "session/live_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <fmt/format.h>

#include "intaglio/representation.h"
#include "intaglio/vec.h"
#include "session/recording.h"
#include "session/simulation.h"

namespace intaglio::session {

MouseDevice::MouseDevice(const haptics::DeviceModel& model, const haptics::Hand& hand, const Vec3& start)
    : model_(model), hand_(hand), wanted_(start), position_(start) {
  target_.publish(start);
}

Vec3 MouseDevice::read() {
  const double dt = 1 / model_.rate;
  const Vec3 way = target_.fetch() - wanted_;
  const double far = way.norm();
  const Vec3 step = far > speed * dt ? Vec3(way * (speed * dt / far)) : way;
  wanted_ += step;
  // Semi-implicit Euler with the hand's damper taken implicitly, as haptics/devices/simulated.cpp.
  const Vec3 push = hand_.stiffness * (wanted_ - position_) + hand_.damping * step / dt + force_;
  velocity_ = (velocity_ + dt / hand_.mass * push) / (1 + dt * hand_.damping / hand_.mass);
  position_ += dt * velocity_;
  return (position_ / model_.resolution).array().round().matrix() * model_.resolution;
}

void AudioTap::play(sound::AudioSource* source) {
  source_.store(source);
  while (busy_.load()) std::this_thread::yield();
}

void AudioTap::render(std::span<float> stereo) noexcept {
  busy_.store(true);
  sound::AudioSource* source = source_.load();
  if (source != nullptr) {
    source->render(stereo);
  } else {
    std::fill(stereo.begin(), stereo.end(), 0.0f);
  }
  busy_.store(false);
  for (const float sample : stereo)
    if (!played_.push(sample))
      lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

void AudioTap::take(std::vector<float>& stereo) {
  while (const float* sample = played_.front()) {
    stereo.push_back(*sample);
    played_.pop();
  }
}

namespace {

using Clock = std::chrono::steady_clock;

// How far physics may fall behind before it leaves steps out, s.
constexpr double patience = 0.1;

Scene with_pen(Scene scene) {
  if (!scene.pen) scene.pen = pen_for(scene);
  return scene;
}

haptics::ServoOptions servo_options(const Scene& scene, const Material& floor, bool feels) {
  haptics::ServoOptions options = pen_options(scene, floor);
  if (!feels) options.representation = Representation::flat;
  return options;
}

// What the pen meets: the floor, or the floor and all grounds as one.
haptics::PenServo make_servo(const Scene& scene, const SceneSurface& surface, bool feels) {
  const haptics::ServoOptions options = servo_options(scene, surface.material, feels);
  // The paper's planes are made of one surface.
  if (surface.grounds.empty() || options.method == haptics::HapticMethod::plane)
    return {surface.surface, options};
  auto solid = std::make_shared<UnionSolid>();
  const double footprint = 2 * options.pen.tip_radius;
  solid->add(std::make_unique<haptics::TexturedSlab>(
      surface.surface, haptics::SolidOptions{options.representation, footprint, scene.surface.thickness}));
  for (std::size_t k = 0; k < surface.grounds.size(); ++k) {
    const SceneSurface& ground = surface.grounds[k];
    const double thickness = scene.grounds[k].thickness;
    const haptics::SolidOptions felt{options.representation, footprint, thickness};
    if (ground.curved) {
      solid->add(
          std::make_unique<haptics::TexturedMesh>(ground.surface, ground.curved->base(), thickness, felt));
    } else {
      solid->add(std::make_unique<haptics::TexturedSlab>(ground.surface, felt));
    }
  }
  return {surface.surface, solid, options};
}

}  // namespace

PenScene pen_for(const Scene& scene) {
  if (scene.pen) return *scene.pen;
  PenScene pen;
  const double side = scene.surface.size.maxCoeff();
  // The whole floor is within the workspace of a desktop device.
  pen.workspace.scale = std::max(1.0, 1.2 * side / pen.device.workspace.x());
  pen.workspace.origin = scene.surface.position;
  pen.length = 0.16 * side;
  pen.radius = 0.005 * side;
  return pen;
}

LiveSession::LiveSession(const Scene& scene, const SceneSurface& surface, const LiveOptions& options,
                         haptics::Device* device)
    : scene_(with_pen(scene)),
      surface_(surface),
      options_(options),
      world_(scene_, surface, options.moves ? scene.surface.representation : Representation::flat),
      gain_db_(options.gain_db) {
  const PenScene& pen = *scene_.pen;
  if (device == nullptr) {
    const Vec3 above =
        scene_.surface.position + 0.3 * scene_.surface.size.maxCoeff() * surface.surface->placement().n();
    mouse_ = std::make_unique<MouseDevice>(pen.device, pen.hand, pen.workspace.to_device(above));
    device = mouse_.get();
  }
  servo_ = std::make_unique<haptics::ServoLoop>(make_servo(scene_, surface, options.feels), *device);
  pushed_.assign(std::min(scene_.balls.size(), haptics::max_balls), Vec3::Zero());
  now_.bodies = std::min(world_.count(), most_live_bodies);
  publish();
}

Result<std::unique_ptr<LiveSession>> LiveSession::create(const Scene& scene, const SceneSurface& surface,
                                                         const LiveOptions& options,
                                                         haptics::Device* device) {
  if (scene.balls.size() + scene.bodies.size() > most_live_bodies)
    return fail(scene.name, fmt::format("has more than {} bodies", most_live_bodies),
                "the window shows no more; intaglio render does");
  return std::unique_ptr<LiveSession>(new LiveSession(scene, surface, options, device));
}

LiveSession::~LiveSession() {
  stop();
}

void LiveSession::start(AudioTap* tap, VoiceBaker* baker) {
  if (running_.exchange(true)) return;
  publish();
  exchange_with_pen();
  servo_->start();
  physics_ = std::thread([this] { run(); });
  if (tap == nullptr || baker == nullptr) return;
  tap_ = tap;
  baker_ = baker;
  ticket_ = baker->request(heard(), surface_, options_.model_cache);
}

void LiveSession::stop() {
  if (!running_.exchange(false)) return;
  physics_.join();
  servo_->stop();
  if (tap_ != nullptr) tap_->play(nullptr);
  baker_ = nullptr;
}

Scene LiveSession::heard() const {
  Scene scene = scene_;
  if (!options_.hears) scene.surface.representation = Representation::flat;
  return scene;
}

void LiveSession::control(const Controls& controls) {
  controls_.publish(controls);
  if (baker_ == nullptr) return;
  auto voices = baker_->take(ticket_);
  if (!voices) return;
  baker_ = nullptr;
  begin_sound(std::move(*voices));
}

void LiveSession::begin_sound(Result<Voices> voices) {
  if (!voices) {
    message_ = "no sound: " + voices.error().message();
    return;
  }
  sound::SynthesizerOptions options = synthesizer_options(heard());
  options.sample_rate = options_.sample_rate;
  if (!options_.hears) options.micro_level = 0;
  sound::LiveSoundOptions live;
  live.gain_db = gain_db_;
  live.delay = 2.0 / scene_.physics.rate + 0.004;
  owned_sound_ = std::make_unique<sound::LiveSound>(options, std::move(voices->bodies), live);
  sound_.store(owned_sound_.get(), std::memory_order_release);
  tap_->play(owned_sound_.get());
}

void LiveSession::lead_pen(const Vec3& tip) {
  if (mouse_) mouse_->lead(scene_.pen->workspace.to_device(tip));
}

void LiveSession::set_listener(const sound::Listener& listener) {
  if (sound::LiveSound* sound = sound_.load()) sound->set_listener(listener);
}

void LiveSession::set_gain_db(double gain_db) {
  gain_db_ = gain_db;
  if (sound::LiveSound* sound = sound_.load()) sound->set_gain_db(gain_db);
}

std::optional<sound::LiveSoundStatus> LiveSession::sound_status() {
  sound::LiveSound* sound = sound_.load();
  if (sound == nullptr) return std::nullopt;
  return sound->status();
}

std::string LiveSession::take_message() {
  return std::exchange(message_, {});
}

void LiveSession::run() {
  const double dt = 1.0 / scene_.physics.rate;
  auto before = Clock::now();
  double owed = 0;  // simulated s that real time is ahead by
  while (running_.load(std::memory_order_acquire)) {
    const Controls controls = controls_.fetch();
    const auto now = Clock::now();
    const double passed = std::chrono::duration<double>(now - before).count();
    before = now;
    if (controls.resets != resets_done_) {
      world_.reset();
      resets_done_ = controls.resets;
    }
    if (controls.paused) {
      owed = 0;
      for (; singles_done_ < controls.single; ++singles_done_) step(controls);
    } else {
      singles_done_ = controls.single;
      owed += passed * controls.speed;
      if (owed > patience) {
        now_.late += static_cast<std::uint64_t>((owed - dt) / dt);
        owed = dt;
      }
      for (; owed >= dt && running_.load(std::memory_order_relaxed); owed -= dt) {
        lateness_.add(std::max(0.0, (owed - dt) / controls.speed));
        step(controls);
      }
    }
    exchange_with_pen();
    publish();
    const double until = controls.paused ? 0.004 : std::clamp((dt - owed) / controls.speed, 0.0002, 0.004);
    std::this_thread::sleep_for(std::chrono::duration<double>(until));
  }
}

void LiveSession::step(const Controls& controls) {
  const std::int64_t start = thread_cpu_ns();
  exchange_with_pen();
  drag(controls);
  world_.step(controls.keys);
  ++now_.steps;
  tell_sound();
  const double took = 1e-9 * static_cast<double>(thread_cpu_ns() - start);
  now_.step_seconds += 0.02 * (took - now_.step_seconds);
}

// A spring from the point that is held to where it is wanted, critically damped for a body that turns little,
// and no stronger than some times its weight.
void LiveSession::drag(const Controls& controls) {
  if (!world_.is_free(controls.dragged)) return;
  dynamics::World& world = world_.world();
  const std::size_t k = controls.dragged - 1;
  const double mass =
      k < scene_.balls.size() ? scene_.balls[k].mass() : scene_.bodies[k - scene_.balls.size()].body.mass();
  constexpr double omega = 25;  // rad/s
  const Vec3 point = world.drawn_pose(controls.dragged).to_world(controls.grip);
  const Vec3 arm = point - world.drawn_pose(controls.dragged).position;
  const Vec3 velocity =
      world.velocity(controls.dragged) + world.angular_velocity(controls.dragged).cross(arm);
  Vec3 force = mass * (omega * omega * (controls.pull_to - point) - 2 * omega * velocity);
  const double most = 60 * mass * 9.81;
  if (force.norm() > most) force *= most / force.norm();
  world.push(controls.dragged, force / scene_.physics.rate, point);
}

void LiveSession::exchange_with_pen() {
  report_ = servo_->latest();
  // No hand is held by a mouse: what a stalled scene made the guard let go of is taken again.
  if (mouse_ && (report_.guard_status & haptics::guard_status::fault) != 0) servo_->rearm();
  dynamics::World& world = world_.world();
  haptics::SceneSnapshot scene;
  scene.ball_count = pushed_.size();
  for (std::size_t k = 0; k < pushed_.size(); ++k) {
    const BodyId id = world_.ball(k);
    const Vec3& sum = report_.ball_impulse[k];
    if (sum != pushed_[k]) world.push(id, sum - pushed_[k]);
    pushed_[k] = sum;
    scene.balls[k] = {world.pose(id).position, world.velocity(id), scene_.balls[k].radius};
  }
  servo_->publish(scene);
  now_.pen = report_;
}

// The pen's contact of this step, from the newest tick of touch.
ContactEvent LiveSession::pen_event() {
  const surface::Placement& place = surface_.surface->placement();
  ContactEvent event;
  event.time = world_.world().time();
  event.duration = 1.0 / scene_.physics.rate;
  event.body = world_.pen();
  event.phase = !report_.touching ? ContactPhase::end
                : pen_touching_   ? ContactPhase::persist
                                  : ContactPhase::begin;
  event.point = report_.proxy;
  event.uv = place.uv(place.to_local(report_.proxy));
  event.n_g = place.n();
  event.n_s = surface_.surface->world_normal(event.uv);
  const Vec3 velocity = (report_.proxy - pen_before_) / event.duration;
  event.v_t = velocity - velocity.dot(event.n_g) * event.n_g;
  event.impulse = report_.force * event.duration;
  const Vec3 up = scene_.pen->direction.normalized();
  event.body_pose = {report_.proxy + 0.5 * scene_.pen->length * up, rotation_onto(Vec3::UnitY(), up)};
  return event;
}

void LiveSession::tell_sound() {
  sound::LiveSound* sound = sound_.load(std::memory_order_acquire);
  const auto tell = [&](const ContactEvent& event) {
    if (sound != nullptr) sound->push(event);
    if (event.phase == ContactPhase::end) return;
    now_.mark[now_.marks++ % most_marks] = {
        event.time, event.body,    event.other, event.phase == ContactPhase::begin, event.point, event.n_g,
        event.n_s,  event.impulse, event.uv};
  };
  for (const ContactEvent& event : world_.world().events()) tell(event);
  if (report_.touching || pen_touching_) tell(pen_event());
  pen_touching_ = report_.touching;
  pen_before_ = report_.proxy;
  if (sound != nullptr) sound->advance(world_.world().time());
}

void LiveSession::publish() {
  now_.time = world_.world().time();
  for (std::size_t k = 0; k < now_.bodies; ++k) now_.pose[k] = world_.pose(k);
  state_.publish(now_);
}

}  // namespace intaglio::session
