// Sound: contact events in, samples out. It starts no thread, and allocates nothing while it plays.
//
//   auto ball = intaglio::ModalModel::load("ball.modes").value();
//   intaglio::Synthesizer synth({.sample_rate = 48000}, {
//       {.id = intaglio::floor_body, .model = slab, .surfaces = {wall}, .is_fixed = true},
//       {.id = 1, .model = ball, .mass = 0.4}});
//   synth.push(event);              // events in order of time
//   synth.render(samples);          // pascals at 1 m      examples/struck_ball.cpp
//
// Offline, push and render on one thread. Live, LiveSound takes events from the physics thread and renders on
// the sound card's, without either waiting (audio.h opens a card). The run time needs no baker: models come
// from files that bake.h or `intaglio bake` writes.
//
// The sound of a contact (Sterling & Lin 2016, §1.2.5.1): when two bodies first touch, both are struck by the
// step's impulse as one Hertz half-sine. While the contact lasts, both are excited by the new part of the
// engine's impulses or by Eq. 1.4 along the texture (`meso`), and by fractal noise of both materials
// (`micro`). A free body that is struck also clicks. The output depends on events and seed alone, not on how
// it is divided into render() calls.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/event.h"
#include "intaglio/material.h"
#include "intaglio/surface.h"
#include "intaglio/vec.h"

namespace intaglio {

// A body as its vibration modes. A handle to immutable data: copies are cheap; any thread.
class ModalModel {
 public:
  // Errors name the file; files are not trusted. Milliseconds.
  static Result<ModalModel> load(const std::filesystem::path& path);
  // Written whole or not at all.
  Result<void> save(const std::filesystem::path& path) const;

  const std::string& name() const;
  const Material& material() const;
  double mass() const;  // kg
  // 0 for a body so small and stiff that all its modes are too high to be heard: only its click is. The
  // functions below return 0 for a mode that does not exist.
  int modes() const;
  double frequency(int mode) const;   // Hz, damped; ascending
  double decay_time(int mode) const;  // s, T60
  // How strongly an impulse along `direction` at a point of the surface, both in the body's frame, excites a
  // mode: kg^-1/2, modal velocity per unit of impulse.
  double gain(int mode, const Vec3& point, const Vec3& direction) const;
  // The same body with all lengths times `scale` (above 0), without baking it anew. Milliseconds.
  ModalModel scaled(double scale) const;

  struct Impl;  // of the library
  explicit ModalModel(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

struct SoundBody {
  BodyId id = 0;                                // by which events name it
  std::optional<ModalModel> model = {};         // unset: the body makes no sound, but what touches it does
  std::optional<MaterialChoice> material = {};  // unset: the model's
  double mass = 1;                              // kg
  std::vector<Surface> surfaces = {};           // its textures, in the order by which events number them
  bool is_fixed = false;                        // its mass counts as infinite
  // m, where it touches; flat by default. A ball's is its radius. A box keeps the default: two flat bodies
  // meet as an edge of 1 cm would. For one that falls on its corners give their rounding (1e-3 for sharp
  // ones): a smaller radius makes a longer, duller blow. Relief adds its own curvature.
  double radius_of_curvature = std::numeric_limits<double>::infinity();
  Pose rest_pose = {};  // until an event tells where it is
};

enum class MesoSource {
  engine_impulses,  // what the physics engine did, §1.3.3: right for reliefs
  normal_map,       // Eq. 1.4 at every texel that a contact crosses: right for normal maps
  height,           // Eq. 1.4 sample by sample with the slope under the contact
};

struct SynthesizerOptions {
  double sample_rate = 44'100;  // Hz
  std::uint64_t seed = 1;
  MesoSource meso = MesoSource::engine_impulses;
  double micro_level = 1;   // noise force per normal force and unit of rms slope; 0 switches it off
  double dead_band = 1e-3;  // of the lasting impulse; smaller changes are the solver's noise
  int max_pulses = 1024;    // blows that sound at once
  int max_pairs = 256;      // pairs that touch at once
  int max_modes = 60'000;   // that sound at once, of all bodies
};

struct Listener {
  Vec3 position = Vec3(0, 0, 1);  // m, world
  Vec3 right = Vec3::UnitX();     // unit, towards the right ear
};

// Counts of events that did not fit; all 0 when all is well.
struct SynthesizerStatus {
  std::uint64_t dropped_pulses = 0;   // raise max_pulses
  std::uint64_t truncated_paths = 0;  // steps with more than 256 texel crossings
  std::uint64_t late_events = 0;      // pushed after their step had been rendered
  std::uint64_t unknown_bodies = 0;   // events that name a body not listed, ignored
  std::uint64_t stolen_groups = 0;    // of 16 modes, faded out for want of room: raise max_modes
  std::uint64_t dropped_pairs = 0;    // raise max_pairs
};

// One thread at a time. Construction takes all memory, milliseconds; render() neither allocates, locks nor
// throws. push() allocates only when more than 4096 events wait.
class Synthesizer {
 public:
  // Errors: a material that is not known, a sample rate that is not above 0.
  static Result<Synthesizer> create(const SynthesizerOptions& options, const std::vector<SoundBody>& bodies);
  Synthesizer(Synthesizer&&) noexcept;
  Synthesizer& operator=(Synthesizer&&) noexcept;
  ~Synthesizer();

  // An event reports the step that ends at event.time and lasts event.duration. Before rendering up to time t
  // push every event whose step begins before t. docs/sound.md is measured at steps of 1/480 s; longer ones
  // sound as well, with each blow placed less exactly unless event.touch_age says when it was.
  void push(const ContactEvent& event);
  // The next samples.size() samples, Pa at 1 m.
  void render(std::span<float> samples);
  // The next stereo.size() / 2 samples at the listener's ears, Pa, interleaved left and right.
  void render_stereo(std::span<float> stereo);
  void set_listener(const Listener& listener);  // from the next sample on, smoothed
  double time() const;                          // s, of the next sample
  bool is_silent() const;                       // nothing rings and nothing is about to
  SynthesizerStatus status() const;

 private:
  struct Impl;
  explicit Synthesizer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Pascals to full scale (-1..1): 20 Pa (117 dB SPL) is 1, moved by `gain_db`, with a soft limiter above -3
// dBFS. `out` may be `pascals`. Any thread, no allocation.
void to_full_scale(std::span<const float> pascals, std::span<float> out, double gain_db = 0);

struct LiveSoundOptions {
  double delay = 0.01;  // s, from an event to its sound; at least the time between two advance() calls
  double gain_db = 0;
  int queue = 4096;  // events
};

struct LiveSoundStatus {
  std::uint64_t events = 0;          // heard or to be heard
  std::uint64_t dropped_events = 0;  // the queue was full
  std::uint64_t waits = 0;           // buffers that physics had not come far enough for
  double delay = 0;                  // s, from an event to its sample, as it is now
  double worst_latency = 0;          // s, from push() to the sample leaving render()
  SynthesizerStatus synthesizer;
};

// A synthesizer between two threads, in full scale (-1..1) stereo. Nothing allocates, locks or throws after
// construction. An event is heard `delay` after it happened by the card's clock; when physics falls behind,
// the delay grows by what is missing and then creeps back.
class LiveSound {
 public:
  // `synthesizer.sample_rate` is the card's. Errors: those of Synthesizer::create.
  static Result<LiveSound> create(const SynthesizerOptions& synthesizer, const std::vector<SoundBody>& bodies,
                                  const LiveSoundOptions& options = {});
  LiveSound(LiveSound&&) noexcept;
  LiveSound& operator=(LiveSound&&) noexcept;
  ~LiveSound();

  // The physics thread: events in order of time; then, after each step, how far time has come (s). Time may
  // pause but never goes back.
  void push(const ContactEvent& event);
  void advance(double time);
  // Any one thread.
  void set_listener(const Listener& listener);
  void set_gain_db(double gain_db);
  LiveSoundStatus status();

  // The sound card's thread: AudioOutput::start() calls it, or your own callback. Interleaved left and right.
  void render(std::span<float> stereo) noexcept;

  struct Impl;  // of the library
  Impl& impl() { return *impl_; }

 private:
  explicit LiveSound(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace intaglio
