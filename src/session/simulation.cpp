#include "session/simulation.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "core/clock.h"
#include "haptics/passivity.h"
#include "intaglio/vec.h"
#include "scene/cost.h"
#include "sound/synthesizer.h"

namespace intaglio::session {

namespace {

constexpr std::size_t block_size = 64;

// Warns of a spring that the pen's device cannot display stably.
std::optional<std::string> pen_stability_warning(const scene::PenSettings& pen) {
  const haptics::DeviceDynamics device{pen.hand.damping, 0.02, pen.device.resolution, pen.device.rate};
  return haptics::stability_warning(device, pen.spring.stiffness, pen.spring.damping);
}

std::vector<haptics::Waypoint> device_path(const scene::PenSettings& pen) {
  std::vector<haptics::Waypoint> path = pen.path;
  for (haptics::Waypoint& waypoint : path) waypoint.position = pen.workspace.to_device(waypoint.position);
  return path;
}

int servo_rate(const scene::Scene& scene) {
  return scene.pen ? int(scene.pen->device.rate) : 1;
}

}  // namespace

sound::Listener listener_of(const scene::CameraSettings& camera) {
  const Vec3 right = (camera.target - camera.eye).cross(Vec3::UnitY());
  return {camera.eye, right.norm() > 0 ? Vec3(right.normalized()) : Vec3(Vec3::UnitX())};
}

Simulation::Simulation(const scene::Scene& scene, const scene::SceneSurface& surface)
    : scene_(scene),
      scene_surface_(surface),
      clock_({scene.physics.rate, servo_rate(scene), scene.sound.sample_rate, scene.video.fps}),
      loop_(scene, surface, scene.surface.representation, scene.surface.representation,
            [this](const ContactEvent& event) { emit(event); }),
      heard_(scene, surface, {scene.sound.sample_rate, 1.0 / scene.physics.rate}),
      sound_delay_(heard_.output_delay()),
      block_(2 * block_size) {
  run_.title = scene.title;
  run_.duration = scene.duration;
  run_.physics_rate = scene.physics.rate;
  run_.servo_rate = servo_rate(scene);
  run_.sample_rate = scene.sound.sample_rate;
  run_.fps = scene.video.fps;
  run_.representation = scene.surface.representation;
  run_.surface = surface.surface;
  run_.texture = scene.surface.texture;
  run_.felt_surface = scene::given(surface, scene::Cue::touch).surface;
  run_.felt_texture = scene.cues.touch.texture.value_or(scene.surface.texture);
  run_.cues = scene.cues;
  for (std::size_t k = 0; k < scene.balls.size(); ++k)
    run_.balls.push_back({loop_.world().ball(k), scene.balls[k].radius});
  if (scene.pen) {
    device_.emplace(scene.pen->device, scene.pen->hand, device_path(*scene.pen));
    servo_.emplace(loop_.pen()->make_servo());
    if (const auto warning = pen_stability_warning(*scene.pen)) run_.warnings.push_back(*warning);
    run_.pen = loop_.world().pen();
  }
  const double picture = scene.cues.picture.delay, motion = scene.cues.ball_motion.delay;
  if (picture + motion > 0) late_poses_.emplace(ticks(picture + motion), poses());
  if (picture > 0) late_pen_.emplace(ticks(picture), std::nullopt);
  if (motion > 0) {
    std::vector<Vec3> start;
    for (std::size_t k = 0; k < run_.balls.size(); ++k) start.push_back(loop_.world().pose(k).position);
    late_positions_.emplace(ticks(motion), std::move(start));
  }
}

Ticks Simulation::ticks(double seconds) const {
  return Ticks(std::llround(seconds * double(clock_.ticks_per_second())));
}

std::vector<Pose> Simulation::poses() const {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < loop_.world().count(); ++k) poses.push_back(loop_.world().pose(k));
  return poses;
}

Result<std::unique_ptr<Simulation>> Simulation::create(const scene::Scene& scene,
                                                       const scene::SceneSurface& surface,
                                                       const scene::VoiceOptions& voices) {
  std::unique_ptr<Simulation> simulation(new Simulation(scene, surface));
  if (auto baked = simulation->bake(voices); !baked) return tl::unexpected(baked.error());
  return simulation;
}

Result<void> Simulation::bake(const scene::VoiceOptions& options) {
  const std::int64_t start = process_cpu_ns();
  auto voices = scene::bake_voices(scene_, scene_surface_, options);
  if (!voices) return tl::unexpected(voices.error());
  run_.voices = std::move(voices->voices);
  synthesizer_ =
      std::make_unique<sound::Synthesizer>(scene::synthesizer_options(scene_), std::move(voices->bodies));
  synthesizer_->set_listener(listener_of(scene_.camera));
  run_.bake_s = double(process_cpu_ns() - start) * 1e-9;
  return {};
}

void Simulation::run_until(Ticks end) {
  // A contact is heard in mid-step and may be dated up to a step back (touch_age), so an event reported at
  // t_n concerns times from t_n - 1.5 dt on: a block may only be rendered that much later.
  const Ticks patience = 2 * clock_.due(1, scene_.physics.rate);
  const auto block_due = [&] {
    return clock_.due(std::int64_t(block_size) * (blocks_done_ + 1), scene_.sound.sample_rate) + patience;
  };
  while (true) {
    const Ticks physics = clock_.due(physics_done_ + 1, scene_.physics.rate);
    const Ticks servo = servo_ ? clock_.due(servo_done_, run_.servo_rate) : std::numeric_limits<Ticks>::max();
    const Ticks block = block_due();
    const Ticks next = std::min({physics, servo, block});
    if (next > end) return;
    if (next == physics) {
      step_physics();
    } else if (next == servo) {
      step_servo();
    } else {
      step_sound();
    }
  }
}

Snapshot Simulation::advance_to_frame(std::int64_t index) {
  run_until(clock_.due(index, scene_.video.fps));
  Snapshot snapshot;
  const Ticks now = clock_.due(index, scene_.video.fps);
  snapshot.time = clock_.seconds(now);
  const std::vector<Pose> all = late_poses_ ? late_poses_->at(now) : poses();
  const auto balls = all.begin() + std::ptrdiff_t(scene_.balls.size());
  snapshot.balls.assign(all.begin(), balls);
  snapshot.bodies.assign(balls, all.end());
  snapshot.pen_tip = late_pen_ ? late_pen_->at(now) : pen_tip_;
  return snapshot;
}

void Simulation::finish() {
  run_until(clock_.due(clock_.steps(scene_.duration, scene_.physics.rate), scene_.physics.rate));
  const std::int64_t samples = clock_.steps(scene_.duration, scene_.sound.sample_rate);
  while (blocks_done_ * std::int64_t(block_size) < samples) step_sound();
  run_.audio_hash = audio_hash_.value();
  run_.event_hash = event_hash_.value();
  run_.momentum_residual = loop_.world().world().momentum_residual();
  run_.surface_bytes = scene_surface_.surface->memory_bytes();
  run_.costs = {
      physics_cost_.summarise(
          {"dynamics", fmt::format("1/{} s step", scene_.physics.rate), 1.0 / scene_.physics.rate}),
      servo_cost_.summarise({"haptics", fmt::format("1/{} s tick", run_.servo_rate), 1.0 / run_.servo_rate}),
      sound_cost_.summarise({"sound", fmt::format("{}-sample block", block_size),
                             double(block_size) / scene_.sound.sample_rate}),
  };
}

void Simulation::emit(const ContactEvent& event) {
  ++run_.event_count;
  heard_.add(event, [this](const ContactEvent& heard) { synthesizer_->push(heard); });
  event_hash_.add(event.time);
  event_hash_.add(std::isnan(event.touch_age) ? -1 : event.touch_age);
  event_hash_.add(event.body);
  event_hash_.add(std::uint8_t(event.phase));
  event_hash_.add(event.other);
  event_hash_.add(event.texture);
  const Vec2 none = Vec2::Zero();
  for (const Vec2& v : {event.uv, event.sweep.value_or(none), event.own ? event.own->uv : none,
                        event.own ? event.own->sweep : none}) {
    event_hash_.add(v.x());
    event_hash_.add(v.y());
  }
  for (const Vec3* v : {&event.point, &event.n_s, &event.v_t, &event.impulse}) {
    for (int k = 0; k < 3; ++k) event_hash_.add((*v)[k]);
  }
  for (Observer* const observer : observers_) observer->on_event(event);
}

void Simulation::step_physics() {
  physics_cost_.measure([&] { loop_.step(servo_ ? &servo_->report() : nullptr); });
  ++physics_done_;
  loop_.emit_contacts();
  heard_.release(loop_.time(), [this](const ContactEvent& heard) { synthesizer_->push(heard); });
  positions_.clear();
  for (std::size_t k = 0; k < run_.balls.size(); ++k) positions_.push_back(loop_.world().pose(k).position);
  const Ticks now = clock_.due(physics_done_, scene_.physics.rate);
  if (late_poses_) late_poses_->put(now, poses());
  if (late_positions_) {
    late_positions_->put(now, positions_);
    positions_ = late_positions_->at(now);
  }
  for (Observer* const observer : observers_) observer->on_step(positions_);
}

void Simulation::step_servo() {
  haptics::ServoSample sample;
  haptics::SceneSnapshot scene = loop_.snapshot();
  const double time = double(servo_done_) / run_.servo_rate;
  // Physics may be slower than the guard's patience with live scenes: here the scene never stalls.
  for (haptics::SceneBall& ball : scene.balls) ball.position += (time - scene.time) * ball.velocity;
  scene.time = time;
  servo_cost_.measure([&] { sample = servo_->tick(*device_, scene, time); });
  device_->advance(1.0 / run_.servo_rate);
  if (late_pen_) late_pen_->put(clock_.due(servo_done_, run_.servo_rate), servo_->report().proxy);
  ++servo_done_;
  pen_tip_ = servo_->report().proxy;
  for (Observer* const observer : observers_) observer->on_tick(sample);
  loop_.emit_pen(servo_->report(), double(servo_done_) / run_.servo_rate, 1.0 / run_.servo_rate);
}

void Simulation::step_sound() {
  sound_cost_.measure([&] {
    synthesizer_->render_stereo(block_);
    sound_delay_.pass(block_);
  });
  // The scene ends within the last block.
  const std::int64_t left =
      clock_.steps(scene_.duration, scene_.sound.sample_rate) - std::int64_t(block_size) * blocks_done_++;
  const std::span stereo(block_.data(),
                         2 * std::size_t(std::clamp(left, std::int64_t{0}, std::int64_t(block_size))));
  sound::to_full_scale(stereo, stereo, {scene_.sound.gain_db});
  audio_hash_.add(std::span<const float>(stereo));
  for (Observer* const observer : observers_) observer->on_sound(stereo);
}

Result<Recording> play(const scene::Scene& scene, const scene::SceneSurface& surface,
                       const scene::VoiceOptions& voices) {
  auto simulation = Simulation::create(scene, surface, voices);
  if (!simulation) return tl::unexpected(simulation.error());
  Recording recording;
  (*simulation)->add_observer(recording);
  (*simulation)->finish();
  static_cast<Run&>(recording) = std::move((*simulation)->run());
  return recording;
}

Result<Recording> play(const scene::Scene& scene) {
  if (auto fits = scene::check_cost(scene, scene::Use::kept); !fits) return tl::unexpected(fits.error());
  const auto surface = scene::make_surface(scene);
  if (!surface) return tl::unexpected(surface.error());
  return play(scene, *surface);
}

}  // namespace intaglio::session
