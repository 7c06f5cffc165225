// Offline simulation: physics, haptics and sound of a scene, advanced in one integer clock.
//
// Steps run in the order in which they are due (core/clock.h); at the same tick physics goes before
// haptics, haptics before sound. A block of sound is rendered once every contact that can be heard in it has
// happened. All that is made goes to observers at once. One thread; deterministic.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/clock.h"
#include "core/hash.h"
#include "intaglio/error.h"
#include "intaglio/event.h"
#include "scene/voices/voices.h"
#include "scene/world.h"
#include "session/heard_contacts.h"
#include "session/late_values.h"
#include "session/recording.h"
#include "session/scene_loop.h"
#include "sound/synthesizer.h"

namespace intaglio::session {

// Ears at the camera.
sound::Listener listener_of(const scene::CameraSettings& camera);

// All poses, for one picture: late where the scene's cues say so.
struct Snapshot {
  double time = 0;
  std::vector<Pose> balls, bodies;
  std::optional<Vec3> pen_tip;
};

class Simulation {
 public:
  // Bakes the modal models (seconds) that are not in the folders of `voices`.
  static Result<std::unique_ptr<Simulation>> create(const scene::Scene& scene,
                                                    const scene::SceneSurface& surface,
                                                    const scene::VoiceOptions& voices = {});

  // Runs everything due up to and including frame `index`, and returns the poses at that time.
  Snapshot advance_to_frame(std::int64_t index);
  // Runs to the end of the scene; then run() is complete except for pictures, their cost and wall time.
  void finish();

  // Hands everything from now on to `observer`, which lives until finish() has returned.
  void add_observer(Observer& observer) { observers_.push_back(&observer); }
  Run& run() { return run_; }

 private:
  Simulation(const scene::Scene& scene, const scene::SceneSurface& surface);

  Result<void> bake(const scene::VoiceOptions& options);
  void run_until(Ticks end);
  void step_physics();
  void step_servo();
  void step_sound();
  void emit(const ContactEvent& event);
  // Ticks of a delay.
  Ticks ticks(double seconds) const;
  std::vector<Pose> poses() const;

  scene::Scene scene_;
  scene::SceneSurface scene_surface_;
  Clock clock_;
  SceneLoop loop_;
  std::optional<haptics::SimulatedDevice> device_;
  std::optional<haptics::PenServo> servo_;
  std::unique_ptr<sound::Synthesizer> synthesizer_;
  HeardContacts heard_;
  DelayLine sound_delay_;
  std::vector<float> block_;

  std::int64_t physics_done_ = 0, servo_done_ = 0, blocks_done_ = 0;
  CostMeter physics_cost_, servo_cost_, sound_cost_;
  Hash event_hash_, audio_hash_;
  std::optional<Vec3> pen_tip_;  // m, as drawn
  std::vector<Vec3> positions_;  // m, of the balls after the last step
  // Only where a cue delays them: poses and the pen in pictures, positions in logs.
  std::optional<LateValues<Ticks, std::vector<Pose>>> late_poses_;
  std::optional<LateValues<Ticks, std::optional<Vec3>>> late_pen_;
  std::optional<LateValues<Ticks, std::vector<Vec3>>> late_positions_;
  std::vector<Observer*> observers_;
  Run run_;
};

// Simulates a scene without rendering and keeps everything. Seconds, mostly modal analysis.
Result<Recording> play(const scene::Scene& scene, const scene::SceneSurface& surface,
                       const scene::VoiceOptions& voices = {});
Result<Recording> play(const scene::Scene& scene);

}  // namespace intaglio::session
