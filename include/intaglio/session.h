// A scene that runs: offline into a recording, or live in real time.
//
//   auto recording = intaglio::simulate(scene, {.progress = [](double done) { ... }});
//   if (recording) recording->save_video("brick.mp4");      // examples/simulate_scene.cpp
//
// Offline is deterministic: the same scene gives the same events and samples, to the bit, on every machine
// (hash()). It first bakes the modal models that are found neither beside the scene nor in `model_cache`
// (seconds). One thread a call.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/event.h"
#include "intaglio/scene.h"
#include "intaglio/vec.h"

namespace intaglio {

struct SimulateOptions {
  std::function<void(double done)> progress = {};  // 0..1, in the calling thread, once a picture
  const std::atomic<bool>* stopped = nullptr;      // set from outside to give up
};

// Where everything is, for one picture.
struct FrameState {
  double time = 0;              // s
  std::vector<Pose> bodies;     // as drawn; of BodyIds 1, 2, ...
  std::optional<Vec3> pen_tip;  // m
};

// One tick of the pen, world frame.
struct PenSample {
  double time = 0;            // s
  Vec3 tip = Vec3::Zero();    // m
  Vec3 force = Vec3::Zero();  // N, on the hand
  Vec3 n_s = Vec3::UnitY();   // normal of the map
  Vec2 uv = Vec2::Zero();
  bool touching = false;
};

// The result of a simulation. A handle to immutable data, kept whole: about 1.5 MB a simulated second with a
// pen.
class Recording {
 public:
  const Scene& scene() const;
  double duration() const;                        // s
  std::span<const ContactEvent> events() const;   // in order of time
  const std::vector<FrameState>& frames() const;  // one a picture
  std::vector<PenSample> pen() const;             // one a servo tick; empty without a pen
  std::span<const float> audio() const;           // -1..1, interleaved left and right, at the camera
  int sample_rate() const;                        // Hz
  const std::vector<std::string>& notes() const;  // what import found, a line each
  double momentum_residual() const;               // N s (World::momentum_residual)

  std::uint64_t event_hash() const;
  std::uint64_t audio_hash() const;
  std::string hash() const;  // of both, as text

  // Written whole or not at all.
  Result<void> save_audio(const std::filesystem::path& wav) const;
  Result<void> save_events(const std::filesystem::path& csv) const;
  // Draws the frames headless and encodes them with the sound: needs EGL, and ffmpeg on PATH.
  Result<void> save_video(const std::filesystem::path& mp4,
                          const std::function<void(double done)>& progress = {}) const;

  struct Impl;  // of the library
  explicit Recording(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

// Errors: a texture that cannot be read, modal analysis that fails, stopped.
Result<Recording> simulate(const Scene& scene, const SimulateOptions& options = {});

struct LiveSessionOptions {
  std::string audio = "default";           // as AudioOptions::device; "": no sound
  std::filesystem::path model_cache = {};  // where baked models are kept; empty: nowhere
  double gain_db = 0;
};

struct LiveSessionState {
  double time = 0;           // s, simulated
  std::uint64_t steps = 0;   // of physics
  std::uint64_t late = 0;    // steps left out because the machine did not keep up
  std::vector<Pose> bodies;  // as drawn; of BodyIds 1, 2, ...
  Vec3 pen_tip = Vec3::Zero(), pen_force = Vec3::Zero();  // m, N
  bool pen_touching = false;
  bool has_sound = false;  // models are there and playing
};

// Physics, touch and sound of a scene, each on a thread of its own, in real time. Call the functions from one
// thread.
class LiveSession {
 public:
  // Tenths of a second. Models are baked in the background where they are missing; meanwhile it is silent.
  static Result<LiveSession> create(const Scene& scene, const LiveSessionOptions& options = {});
  LiveSession(LiveSession&&) noexcept;
  LiveSession& operator=(LiveSession&&) noexcept;
  ~LiveSession();  // stops

  void start();
  void stop();
  LiveSessionState state();
  void pause(bool paused);
  void step();                        // one physics step, while paused
  void reset();                       // bodies go back to where they began
  void lead_pen(const Vec3& tip);     // where the simulated hand wants the pen's tip, world metres
  void press(bool left, bool right);  // the keys of a scene with flippers
  // Holds a body at `grip` (its frame) and pulls that point to `target` (world); std::nullopt lets go.
  void drag(std::optional<BodyId> body, const Vec3& grip = Vec3::Zero(), const Vec3& target = Vec3::Zero());
  std::string take_message();  // what went wrong with the sound, once; usually empty

 private:
  struct Impl;
  explicit LiveSession(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace intaglio
