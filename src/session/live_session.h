// A scene that runs in real time: physics, touch and sound, each in a thread of its own.
//
//   window ─ Controls ▶ physics thread ─ LiveState ▶ window        by Latest slots
//                        │  ▲
//        SceneSnapshot   ▼  │ ServoReport        ContactEvents ▶ LiveSound ▶ the audio device's thread
//                     servo thread
//
// The scene says what each sense is given (Scene::cues). Delays of bodies and sounds are simulated
// time, those of touch and of the drawn pen real time.
//
// Physics takes whole steps by the steady clock; when the machine does not keep up, steps are left out and
// counted. Sound starts when its models are there, from a cache or from a baking thread; until then it is
// silent. The touch loop keeps running while the scene is paused.
//
// create() takes some tenths of a second; call it in a thread of its own to keep a window responsive. All
// other members: one thread, the window's. Values between threads cross in latest-value slots
// (core/lock_free.h). World frame, SI.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/lock_free.h"
#include "haptics/device.h"
#include "haptics/servo_loop.h"
#include "intaglio/event.h"
#include "scene/voices/voices.h"
#include "session/heard_contacts.h"
#include "session/late_values.h"
#include "session/scene_loop.h"
#include "sound/audio_device.h"
#include "sound/live_sound.h"

namespace intaglio::session {

inline constexpr std::size_t max_live_bodies = 256, max_marks = 64;

struct Controls : StepInput {
  bool paused = false;
  double speed = 1;                // simulated seconds a second, 0.01..1
  std::uint64_t single_steps = 0;  // steps to take while paused, counted since the start
  std::uint64_t resets = 0;        // counted since the start
};

// One contact of one step, drawn until it fades.
struct ContactMark {
  double time = 0;
  BodyId body = 0, other = floor_body;
  bool begins = false;
  Vec3 point = Vec3::Zero(), n_g = Vec3::UnitY(), n_s = Vec3::UnitY(), impulse = Vec3::Zero();
  Vec2 uv = Vec2::Zero();
};

struct LiveState {
  double time = 0;                         // s, simulated
  std::uint64_t steps = 0;                 // physics steps
  std::uint64_t dropped_steps = 0;         // steps left out because the machine could not keep up
  double step_seconds = 0;                 // CPU time of a step, smoothed
  std::size_t bodies = 0;                  // balls, then the scene's other bodies
  std::array<Pose, max_live_bodies> pose;  // as drawn: late where the scene's cues say so
  std::uint64_t mark_count = 0;            // since the start; the newest is at (mark_count - 1) % max_marks
  std::array<ContactMark, max_marks> marks;
  haptics::ServoReport pen;  // tip and proxy as drawn
};

// A haptic device led by the mouse: a PHANToM Desktop in a simulated hand that pulls towards where the mouse
// points. The force holds the hand back, so that the pen stays on the relief.
//
// set_target() from one thread, read() and write() from the servo thread; none of them waits. Real-time.
class MouseDevice : public haptics::Device {
 public:
  // `start` in the device's workspace, metres.
  MouseDevice(const haptics::DeviceModel& model, const haptics::Hand& hand, const Vec3& start);

  // Where the hand pulls the tip, device workspace; it moves there at `speed` m/s at most.
  void set_target(const Vec3& target) { target_.publish(target); }

  Vec3 read() override;
  void write(const haptics::GuardedForce& force) override { force_ = force.newtons(); }

 private:
  static constexpr double speed = 0.6;  // m/s, well below the guard's limit

  haptics::DeviceModel model_;
  haptics::Hand hand_;
  Latest<Vec3> target_;
  // The servo thread's.
  Vec3 wanted_, position_, velocity_ = Vec3::Zero(), force_ = Vec3::Zero();
};

// Sits between an audio device and its source: the source can be changed while the device runs, and the
// played samples can be shown (a scope) and kept (a recording).
//
// set_source() and drain() from one thread each, render() from the device's. render() neither allocates nor
// waits; set_source() waits until no render() uses the old source.
class AudioTap : public sound::AudioSource {
 public:
  void set_source(sound::AudioSource* source);
  void render(std::span<float> stereo) noexcept override;

  // Appends what was played since the last call, interleaved; samples older than two seconds are lost.
  void drain(std::vector<float>& stereo);

 private:
  std::atomic<sound::AudioSource*> source_{nullptr};
  std::atomic<bool> busy_{false};
  SpscQueue<float> played_{2 * 2 * 48'000};
};

struct LiveSessionOptions {
  // Which senses take the texture; the others take the bare surface.
  bool moves = true, feels = true, hears = true;
  std::filesystem::path model_cache;  // empty: none
  int sample_rate = 44'100;           // of the audio device
  double gain_db = 0;
};

// The scene's pen, or one sized to its floor.
scene::PenSettings pen_for(const scene::Scene& scene);

class LiveSession {
 public:
  // `surface` is the result of make_surface(scene); the caller keeps it, so that an unchanged texture is not
  // built again. `device` holds the pen and must outlive the session; null: a MouseDevice.
  static Result<std::unique_ptr<LiveSession>> create(const scene::Scene& scene,
                                                     const scene::SceneSurface& surface,
                                                     const LiveSessionOptions& options,
                                                     haptics::Device* device = nullptr);
  ~LiveSession();

  // Bodies continue where `other`, a stopped session of the same scene, had them.
  void follow(const LiveSession& other) {
    loop_.world().follow(other.loop_.world());
    if (late_poses_) late_poses_->restart(poses());
  }
  // Resets and single steps that `other`, a stopped session, has done are not repeated.
  void continue_counters(const LiveSession& other) {
    singles_done_ = other.singles_done_;
    resets_done_ = other.resets_done_;
  }
  // `tap` is what the audio device plays, `baker` makes the modal models; null: no sound.
  void start(AudioTap* tap, scene::VoiceBaker* baker);
  void stop();

  // Once per picture: the input of physics from now on.
  void set_controls(const Controls& controls);
  // The newest state. Valid until the next call.
  const LiveState& state() { return state_.fetch(); }

  // Where the mouse pulls the pen's tip, world; ignored with another device.
  void set_pen_target(const Vec3& tip);
  void set_listener(const sound::Listener& listener);
  void set_gain_db(double gain_db);

  const scene::Scene& scene() const { return scene_; }
  const scene::SceneSurface& surface() const { return surface_; }
  const LiveSessionOptions& options() const { return options_; }
  bool is_free(BodyId id) const { return loop_.world().is_free(id); }
  haptics::ServoLoop& servo() { return *servo_; }
  // How late physics steps began.
  const haptics::LatencyHistogram& lateness() const { return lateness_; }
  std::optional<sound::LiveSoundStatus> sound_status();
  bool has_sound() const { return sound_.load() != nullptr; }
  // The error of the sound, once; empty when there is none.
  std::string take_message();

 private:
  LiveSession(const scene::Scene& scene, const scene::SceneSurface& surface,
              const LiveSessionOptions& options, haptics::Device* device);

  void begin_sound(Result<scene::Voices> voices);
  scene::Scene heard() const;
  void run();
  void step(const Controls& controls);
  void exchange_with_pen(double speed);
  void emit(const ContactEvent& event);
  void push_heard(const ContactEvent& event);
  std::vector<Pose> poses() const;
  void publish();

  scene::Scene scene_;
  scene::SceneSurface surface_;
  LiveSessionOptions options_;
  SceneLoop loop_;
  std::unique_ptr<MouseDevice> mouse_;
  std::unique_ptr<haptics::ServoLoop> servo_;
  haptics::ServoReport report_;  // the physics thread's newest
  HeardContacts heard_;
  // Only where a cue delays them: bodies by simulated time, the pen by the steady clock, s.
  std::optional<LateValues<double, std::vector<Pose>>> late_poses_;
  std::optional<LateValues<double, std::array<Vec3, 2>>> late_pen_;  // tip, proxy

  AudioTap* tap_ = nullptr;
  scene::VoiceBaker* baker_ = nullptr;
  std::uint64_t ticket_ = 0;
  std::unique_ptr<sound::LiveSound> owned_sound_;
  std::atomic<sound::LiveSound*> sound_{nullptr};
  std::atomic<double> gain_db_;
  std::thread physics_;
  std::atomic<bool> running_{false};
  std::string message_;

  Latest<Controls> controls_;
  Latest<LiveState> state_;
  LiveState now_;
  std::uint64_t singles_done_ = 0, resets_done_ = 0;
  haptics::LatencyHistogram lateness_;
};

}  // namespace intaglio::session
