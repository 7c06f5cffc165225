// A scene that is alive: physics, touch and sound each in a thread of its own, in real time.
//
//   window ─ Controls ▶ physics thread ─ LiveState ▶ window        by core/latest slots
//                        │  ▲
//        SceneSnapshot   ▼  │ ServoReport        ContactEvents ▶ LiveSound ▶ the audio device's thread
//                     servo thread
//
// Physics takes whole steps by the steady clock; when the machine does not keep up it leaves steps out and
// counts them. Sound begins when its models are there: they come from a cache, or are baked by a thread of
// their own, and meanwhile it is silent. The touch loop goes on while the scene is paused, as a hand would.
//
// create() takes what making the surfaces took, some tenths of a second; call it in a thread of its own to
// keep a window alive. All other members: one thread, the window's.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "intaglio/core/latest.h"
#include "intaglio/haptics/lateness.h"
#include "intaglio/haptics/servo_loop.h"
#include "intaglio/session/live/audio_tap.h"
#include "intaglio/session/live/live_state.h"
#include "intaglio/session/live/mouse_device.h"
#include "intaglio/session/live/voice_baker.h"
#include "intaglio/session/scene_world.h"
#include "intaglio/sound/live_sound.h"

namespace intaglio::session {

struct LiveOptions {
  // Which senses take the texture; the others take the bare rectangle.
  bool moves = true, feels = true, hears = true;
  std::filesystem::path model_cache;  // empty: none
  int sample_rate = 44'100;           // of the audio device
  double gain_db = 0;
};

// The scene's pen, or one that fits its floor.
PenScene pen_for(const Scene& scene);

class LiveSession {
 public:
  // `surface` is make_surface(scene)'s, so that an unchanged texture need not be made again. `device` is the
  // pen's; none: a MouseDevice. It outlives the session.
  static Result<std::unique_ptr<LiveSession>> create(const Scene& scene, const SceneSurface& surface,
                                                     const LiveOptions& options,
                                                     haptics::Device* device = nullptr);
  ~LiveSession();

  // Bodies go on where `other`, a stopped session of the same scene, had them.
  void follow(const LiveSession& other) { world_.follow(other.world_); }
  // Resets and single steps that `other`, a stopped session, has done are not asked of this one.
  void count_from(const LiveSession& other) {
    singles_done_ = other.singles_done_;
    resets_done_ = other.resets_done_;
  }
  // `tap` is what the audio device plays, `baker` makes what rings; null: no sound.
  void start(AudioTap* tap, VoiceBaker* baker);
  void stop();

  // Once a picture: what is wanted of physics from now on.
  void control(const Controls& controls);
  // The newest state. Valid until the next call.
  const LiveState& state() { return state_.fetch(); }

  // Where the mouse wants the pen's tip, world; nothing happens with another device.
  void lead_pen(const Vec3& tip);
  void set_listener(const sound::Listener& listener);
  void set_gain_db(double gain_db);

  const Scene& scene() const { return scene_; }
  const SceneSurface& surface() const { return surface_; }
  const LiveOptions& options() const { return options_; }
  bool is_free(BodyId id) const { return world_.is_free(id); }
  BodyId pen_id() const { return world_.pen(); }
  haptics::ServoLoop& servo() { return *servo_; }
  // Of physics: how late a step was begun.
  const haptics::Lateness& lateness() const { return lateness_; }
  std::optional<sound::LiveStatus> sound_status();
  bool has_sound() const { return sound_.load() != nullptr; }
  // What went wrong with the sound, once; empty when nothing did.
  std::string take_message();

 private:
  LiveSession(const Scene& scene, const SceneSurface& surface, const LiveOptions& options,
              haptics::Device* device);

  void begin_sound(Result<Voices> voices);
  Scene heard() const;
  void run();
  void step(const Controls& controls);
  void drag(const Controls& controls);
  void exchange_with_pen();
  void tell_sound();
  ContactEvent pen_event();
  void publish();

  Scene scene_;
  SceneSurface surface_;
  LiveOptions options_;
  SceneWorld world_;
  std::unique_ptr<MouseDevice> mouse_;
  std::unique_ptr<haptics::ServoLoop> servo_;
  haptics::ServoReport report_;  // the physics thread's newest
  std::vector<Vec3> pushed_;
  Vec3 pen_before_ = Vec3::Zero();
  bool pen_touching_ = false;

  AudioTap* tap_ = nullptr;
  VoiceBaker* baker_ = nullptr;
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
  haptics::Lateness lateness_;
};

}  // namespace intaglio::session
