#include "session/live_session.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "intaglio/representation.h"
#include "intaglio/vec.h"
#include "session/cost_meter.h"
#include "session/simulation.h"

namespace intaglio::session {

MouseDevice::MouseDevice(const haptics::DeviceModel& model, const haptics::Hand& hand, const Vec3& start)
    : model_(model), hand_(hand), wanted_(start), position_(start) {
  target_.publish(start);
}

Vec3 MouseDevice::read() {
  const double dt = 1 / model_.rate;
  const Vec3 way = target_.fetch() - wanted_;
  const double distance = way.norm();
  const Vec3 step = distance > speed * dt ? Vec3(way * (speed * dt / distance)) : way;
  wanted_ += step;
  // As SimulatedDevice: m v' = k (w - x) + c (w' - v) + f, semi-implicit Euler with the damper implicit:
  //   v <- (v + dt/m F) / (1 + dt c/m),   F = k (w - x) + c w' + f.
  // Stable for any c; k needs dt < 2 sqrt(m/k).
  const Vec3 push = hand_.stiffness * (wanted_ - position_) + hand_.damping * step / dt + force_;
  velocity_ = (velocity_ + dt / hand_.mass * push) / (1 + dt * hand_.damping / hand_.mass);
  position_ += dt * velocity_;
  return (position_ / model_.resolution).array().round().matrix() * model_.resolution;
}

void AudioTap::set_source(sound::AudioSource* source) {
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
  for (const float sample : stereo) (void)played_.push(sample);
}

void AudioTap::drain(std::vector<float>& stereo) {
  while (const float* sample = played_.front()) {
    stereo.push_back(*sample);
    played_.pop();
  }
}

namespace {

using SteadyClock = std::chrono::steady_clock;

// How far physics may fall behind before it leaves out steps, s.
constexpr double patience = 0.1;

scene::Scene with_pen(scene::Scene scene) {
  if (!scene.pen) scene.pen = pen_for(scene);
  return scene;
}

Representation representation_for(const scene::Scene& scene, bool takes_texture) {
  return takes_texture ? scene.surface.representation : Representation::flat;
}

}  // namespace

scene::PenSettings pen_for(const scene::Scene& scene) {
  if (scene.pen) return *scene.pen;
  scene::PenSettings pen;
  const double side = scene.surface.size.maxCoeff();
  // The whole floor fits into the workspace of a desktop device.
  pen.workspace.scale = std::max(1.0, 1.2 * side / pen.device.workspace.x());
  pen.workspace.origin = scene.surface.position;
  pen.length = 0.16 * side;
  pen.radius = 0.005 * side;
  return pen;
}

LiveSession::LiveSession(const scene::Scene& scene, const scene::SceneSurface& surface,
                         const LiveSessionOptions& options, haptics::Device* device)
    : scene_(with_pen(scene)),
      surface_(surface),
      options_(options),
      loop_(scene_, surface, representation_for(scene, options.moves),
            representation_for(scene, options.feels), [this](const ContactEvent& event) { emit(event); }),
      heard_(scene_, surface, {.sample_rate = options.sample_rate, .delays_output = false}),
      gain_db_(options.gain_db) {
  const scene::PenSettings& pen = *scene_.pen;
  if (device == nullptr) {
    const Vec3 above =
        scene_.surface.position + 0.3 * scene_.surface.size.maxCoeff() * surface.surface->placement().n();
    mouse_ = std::make_unique<MouseDevice>(pen.device, pen.hand, pen.workspace.to_device(above));
    device = mouse_.get();
  }
  servo_ = std::make_unique<haptics::ServoLoop>(loop_.pen()->make_servo(), *device);
  now_.bodies = std::min(loop_.world().count(), max_live_bodies);
  const double picture = scene_.cues.picture.delay, motion = scene_.cues.ball_motion.delay;
  // Half a step less than the delay, so that rounding does not decide which step is drawn.
  if (picture + motion > 0) late_poses_.emplace(picture + motion - 0.5 / scene_.physics.rate, poses());
  if (picture > 0) {
    const Vec3 tip = scene_.surface.position;
    late_pen_.emplace(picture, std::array{tip, tip});
  }
  publish();
}

Result<std::unique_ptr<LiveSession>> LiveSession::create(const scene::Scene& scene,
                                                         const scene::SceneSurface& surface,
                                                         const LiveSessionOptions& options,
                                                         haptics::Device* device) {
  if (scene.balls.size() + scene.bodies.size() > max_live_bodies)
    return fail(scene.name, fmt::format("has more than {} bodies", max_live_bodies),
                "the window shows no more; intaglio render has no such limit");
  return std::unique_ptr<LiveSession>(new LiveSession(scene, surface, options, device));
}

LiveSession::~LiveSession() {
  stop();
}

void LiveSession::start(AudioTap* tap, scene::VoiceBaker* baker) {
  if (running_.exchange(true)) return;
  publish();
  exchange_with_pen(1);
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
  if (tap_ != nullptr) tap_->set_source(nullptr);
  baker_ = nullptr;
}

scene::Scene LiveSession::heard() const {
  scene::Scene scene = scene_;
  scene.surface.representation = representation_for(scene_, options_.hears);
  return scene;
}

void LiveSession::set_controls(const Controls& controls) {
  controls_.publish(controls);
  if (baker_ == nullptr) return;
  auto voices = baker_->take(ticket_);
  if (!voices) return;
  baker_ = nullptr;
  begin_sound(std::move(*voices));
}

void LiveSession::begin_sound(Result<scene::Voices> voices) {
  if (!voices) {
    message_ = "no sound: " + voices.error().message();
    return;
  }
  sound::SynthesizerOptions options = scene::synthesizer_options(heard());
  options.sample_rate = options_.sample_rate;
  if (!options_.hears) options.micro_level = 0;
  sound::LiveSoundOptions live;
  live.gain_db = gain_db_;
  live.delay = 2.0 / scene_.physics.rate + 0.004;
  owned_sound_ = std::make_unique<sound::LiveSound>(options, std::move(voices->bodies), live);
  sound_.store(owned_sound_.get(), std::memory_order_release);
  tap_->set_source(owned_sound_.get());
}

void LiveSession::set_pen_target(const Vec3& tip) {
  if (mouse_) mouse_->set_target(scene_.pen->workspace.to_device(tip));
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
  auto last = SteadyClock::now();
  double backlog = 0;  // simulated s by which real time is ahead
  while (running_.load(std::memory_order_acquire)) {
    const Controls controls = controls_.fetch();
    const auto now = SteadyClock::now();
    const double elapsed = std::chrono::duration<double>(now - last).count();
    last = now;
    if (controls.resets != resets_done_) {
      loop_.world().reset();
      resets_done_ = controls.resets;
    }
    if (controls.paused) {
      backlog = 0;
      for (; singles_done_ < controls.single_steps; ++singles_done_) step(controls);
    } else {
      singles_done_ = controls.single_steps;
      backlog += elapsed * controls.speed;
      if (backlog > patience) {
        now_.dropped_steps += std::uint64_t((backlog - dt) / dt);
        backlog = dt;
      }
      for (; backlog >= dt && running_.load(std::memory_order_relaxed); backlog -= dt) {
        lateness_.add(std::max(0.0, (backlog - dt) / controls.speed));
        step(controls);
      }
    }
    exchange_with_pen(controls.paused ? 0 : controls.speed);
    publish();
    const double until = controls.paused ? 0.004 : std::clamp((dt - backlog) / controls.speed, 0.0002, 0.004);
    std::this_thread::sleep_for(std::chrono::duration<double>(until));
  }
}

void LiveSession::step(const Controls& controls) {
  const std::int64_t start = thread_cpu_ns();
  exchange_with_pen(controls.paused ? 0 : controls.speed);
  loop_.step(&report_, controls);
  ++now_.steps;
  loop_.emit_contacts();
  loop_.emit_pen(report_, loop_.time(), 1.0 / scene_.physics.rate);
  if (late_poses_) late_poses_->put(loop_.time(), poses());
  heard_.release(loop_.time(), [this](const ContactEvent& heard) { push_heard(heard); });
  if (sound::LiveSound* sound = sound_.load(std::memory_order_acquire)) sound->advance(loop_.time());
  const double cost = 1e-9 * double(thread_cpu_ns() - start);
  now_.step_seconds += 0.02 * (cost - now_.step_seconds);
}

void LiveSession::exchange_with_pen(double speed) {
  report_ = servo_->latest();
  // There is no hand to protect behind a mouse: a guard that let go because the scene stalled is re-armed.
  if (mouse_ && (report_.guard_status & haptics::guard_status::fault) != 0) servo_->rearm();
  servo_->publish(loop_.snapshot(speed));
  now_.pen = report_;
}

void LiveSession::emit(const ContactEvent& event) {
  heard_.add(event, [this](const ContactEvent& heard) { push_heard(heard); });
  if (event.phase == ContactPhase::end) return;
  now_.marks[now_.mark_count++ % max_marks] = {
      event.time, event.body,    event.other, event.phase == ContactPhase::begin, event.point, event.n_g,
      event.n_s,  event.impulse, event.uv};
}

void LiveSession::push_heard(const ContactEvent& event) {
  if (sound::LiveSound* sound = sound_.load(std::memory_order_acquire)) sound->push(event);
}

std::vector<Pose> LiveSession::poses() const {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < now_.bodies; ++k) poses.push_back(loop_.world().pose(k));
  return poses;
}

void LiveSession::publish() {
  now_.time = loop_.time();
  for (std::size_t k = 0; k < now_.bodies; ++k) now_.pose[k] = loop_.world().pose(k);
  if (late_poses_) std::ranges::copy(late_poses_->at(now_.time), now_.pose.begin());
  if (late_pen_) {
    const double now = std::chrono::duration<double>(SteadyClock::now().time_since_epoch()).count();
    late_pen_->put(now, {report_.tip, report_.proxy});
    const auto& [tip, proxy] = late_pen_->at(now);
    now_.pen.tip = tip;
    now_.pen.proxy = proxy;
  }
  state_.publish(now_);
}

}  // namespace intaglio::session
