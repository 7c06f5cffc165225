#include <utility>

#include "intaglio/session.h"
#include "scene/api.h"
#include "session/live_session.h"
#include "sound/audio/devices.h"

namespace intaglio {

struct LiveSession::Impl {
  std::unique_ptr<session::LiveSession> live;
  sound::OpenedDevice audio = {};  // none: no sound
  session::AudioTap tap = {};
  scene::VoiceBaker baker = {};
  session::Controls controls = {};
  bool is_running = false;

  ~Impl() { stop(); }
  void stop() {
    if (!std::exchange(is_running, false)) return;
    live->stop();
    if (audio.device) audio.device->stop();
  }
};

LiveSession::LiveSession(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LiveSession::LiveSession(LiveSession&&) noexcept = default;
LiveSession& LiveSession::operator=(LiveSession&&) noexcept = default;
LiveSession::~LiveSession() = default;

Result<LiveSession> LiveSession::create(const Scene& scene, const LiveSessionOptions& options) {
  const scene::Scene& from = scene.impl().scene;
  const auto surface = scene::make_surface(from);
  if (!surface) return tl::unexpected(surface.error());
  auto impl = std::make_unique<Impl>();
  session::LiveSessionOptions live;
  live.model_cache = options.model_cache;
  live.gain_db = options.gain_db;
  if (!options.audio.empty()) {
    auto opened = sound::open_audio_device({.device = options.audio});
    if (!opened) return tl::unexpected(opened.error());
    impl->audio = std::move(*opened);
    live.sample_rate = impl->audio.device->sample_rate();
  }
  auto made = session::LiveSession::create(from, *surface, live);
  if (!made) return tl::unexpected(made.error());
  impl->live = std::move(*made);
  return LiveSession(std::move(impl));
}

void LiveSession::start() {
  if (std::exchange(impl_->is_running, true)) return;
  impl_->live->set_controls(impl_->controls);
  const bool sounds = impl_->audio.device && impl_->audio.device->start(impl_->tap);
  impl_->live->start(sounds ? &impl_->tap : nullptr, sounds ? &impl_->baker : nullptr);
}
void LiveSession::stop() {
  impl_->stop();
}

LiveSessionState LiveSession::state() {
  impl_->live->set_controls(impl_->controls);
  const session::LiveState& from = impl_->live->state();
  LiveSessionState state;
  state.time = from.time;
  state.steps = from.steps;
  state.late = from.dropped_steps;
  state.bodies.assign(from.pose.begin(), from.pose.begin() + std::ptrdiff_t(from.bodies));
  state.pen_tip = from.pen.proxy;
  state.pen_force = from.pen.felt;
  state.pen_touching = from.pen.touching;
  state.has_sound = impl_->live->has_sound();
  return state;
}

void LiveSession::pause(bool paused) {
  impl_->controls.paused = paused;
  impl_->live->set_controls(impl_->controls);
}
void LiveSession::step() {
  ++impl_->controls.single_steps;
  impl_->live->set_controls(impl_->controls);
}
void LiveSession::reset() {
  ++impl_->controls.resets;
  impl_->live->set_controls(impl_->controls);
}
void LiveSession::lead_pen(const Vec3& tip) {
  impl_->live->set_pen_target(tip);
}
void LiveSession::press(bool left, bool right) {
  impl_->controls.keys = (left ? scene::left_key : 0) | (right ? scene::right_key : 0);
  impl_->live->set_controls(impl_->controls);
}
void LiveSession::drag(std::optional<BodyId> body, const Vec3& grip, const Vec3& target) {
  impl_->controls.dragged = body.value_or(floor_body);
  impl_->controls.grip = grip;
  impl_->controls.pull_to = target;
  impl_->live->set_controls(impl_->controls);
}
std::string LiveSession::take_message() {
  return impl_->live->take_message();
}

}  // namespace intaglio
