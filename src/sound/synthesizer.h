// Where the ears are, and how loud a source is in each: distance and direction, no room, no head.
//
// Pure, any thread. Pressure falls as 1 / distance from the metre at which sources are given, and no further
// inwards than `nearest`. Direction is a constant-power pan: what lies ahead (or behind, or above) is equally
// loud on both sides, at the pressure of its distance; the mean square of both sides is that of the pressure
// wherever the source is.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "intaglio/event.h"
#include "intaglio/vec.h"
#include "sound/modal_model.h"
#include "surface/surface.h"

namespace intaglio::sound {

struct Listener {
  static constexpr double nearest = 0.1;  // m

  Vec3 position = Vec3(0, 0, 1);  // m, world
  Vec3 right = Vec3::UnitX();     // unit, towards the right ear
};

struct EarGains {
  float left = 1, right = 1;
};

EarGains ear_gains(const Listener& listener, const Vec3& source);

// From contact events to sound: pascals at 1 m, sample by sample.
//
// Feed it events, then ask for the samples. Both bodies of a pair ring: `body` is struck by the blow, `other`
// by its opposite. What a contact sounds like has three levels (§1.2.5.1):
//
// - macro, the first touch: the impulse of its step as one Hertz half-sine in the middle of the step.
// - meso, while contact lasts: the engine's impulses (§1.3.3), of which only what is new strikes (see
//   contact_step.h), each where within its step the contact crossed the sharpest bend of a texture; or
//   Eq. 1.4 at every texel that the contact crosses (rubbing.h); or Eq. 1.4 sample by sample with the slope of
//   the height under the contact patch (rubbing.h). Of both bodies, where both have textures: a ball that
//   rolls sweeps over its own as fast as over the floor's; what is dragged sweeps over the floor's only.
// - micro, while contact lasts: fractal noise of both surfaces by the distance swept over each, level by
//   normal force (rubbing.h).
//
// A free body that is struck also clicks: its sudden acceleration pushes the air (modal_bank.h).
//
// An event reports the step that ends at `event.time` and lasts `event.duration`; the points of one pair with
// equal times are one step, and steps of one pair come in order. A contact lasts until its end is reported:
// one of which no more is heard rests, its body asleep, and is silent. Before render() up to time t, every
// event whose step begins before t must have been pushed; one that comes late sounds at once and is counted.
// The output depends on events and seed alone, not on how render() calls are cut.
//
// One thread. render() neither allocates, locks nor throws: at most `max_pulses` blows sound at once (then
// the smallest is dropped and counted), at most `max_pairs` pairs touch at once (then a new one is dropped
// and counted), at most `max_modes` modes go on sounding (the quietest are faded out), at most 8 points of a
// step are told apart, at most 256 texel crossings a step. push() allocates only while has_room() is false:
// when more than 4,096 events wait.

enum class MesoSource { engine_impulses, normal_map, height };

struct SynthesizerOptions {
  double sample_rate = 44'100;  // Hz
  std::uint64_t seed = 1;
  MesoSource meso = MesoSource::engine_impulses;
  double micro_level = 1;   // noise force per normal force and unit of rms slope; 0 switches it off
  double dead_band = 1e-3;  // of the lasting impulse; smaller changes are the solver's noise
  int max_pulses = 1024;
  int max_pairs = 256;
  int max_modes = 60'000;  // that sound at once, of all bodies
};

struct SoundBody {
  BodyId id = 0;
  std::shared_ptr<const ModalModel> model;  // absent: the body makes no sound
  std::optional<Material> material;         // unset: the model's, or a dull one
  double mass = 1;                          // kg
  bool is_fixed = false;                    // its mass counts as infinite
  // m, where it touches; flat by default. Relief adds its own curvature.
  double radius_of_curvature = std::numeric_limits<double>::infinity();
  Pose rest_pose;  // until an event tells where it is
  // Its textures, for meso, in the order by which events number them.
  std::vector<std::shared_ptr<const surface::Surface>> textures;
};

struct SynthesizerStatus {
  std::uint64_t dropped_pulses = 0;   // raise max_pulses
  std::uint64_t truncated_paths = 0;  // steps with more than 256 texel crossings
  std::uint64_t late_events = 0;      // pushed after their step had been rendered
  std::uint64_t unknown_bodies = 0;   // events that name a body not listed, ignored
  std::uint64_t stolen_groups = 0;    // of 16 modes, faded out for want of room: raise max_modes
  std::uint64_t dropped_pairs = 0;    // events of pairs for which there was no room: raise max_pairs
};

class Synthesizer {
 public:
  Synthesizer(const SynthesizerOptions& options, std::vector<SoundBody> bodies);
  Synthesizer(Synthesizer&&) noexcept;
  Synthesizer& operator=(Synthesizer&&) noexcept;
  ~Synthesizer();

  void push(const ContactEvent& event);
  bool has_room() const;
  // The next out.size() samples, Pa at 1 m.
  void render(std::span<float> out);
  // The same at the listener's ears, interleaved left and right: out.size() / 2 samples. A body sounds from
  // where it is, a fixed one from where it was last touched.
  void render_stereo(std::span<float> out);
  // From the next sample on; a move is smoothed over 64 samples.
  void set_listener(const Listener& listener);
  // Of the next sample, s.
  double time() const;
  double sample_rate() const;

  bool is_silent() const;  // nothing rings and nothing is about to
  SynthesizerStatus status() const;

 private:
  class Engine;
  std::unique_ptr<Engine> engine_;
};

// Where loudness is decided: pascals at 1 m become full scale here, and nowhere else.
//
// 20 Pa peak (117 dB SPL) is full scale, so that a clap or a hammer blow fits; `gain_db` moves all of it. A
// soft limiter follows: it has no memory, passes everything below -3 dBFS untouched, bends smoothly above,
// and never reaches beyond 1. Pure, any thread, no allocation.

inline constexpr double full_scale_pascal = 20;
inline constexpr float limiter_knee = 0.70794578f;  // -3 dBFS

struct LevelOptions {
  double gain_db = 0;
};

// The limiter: x where |x| <= limiter_knee, tending to +-1 beyond; odd, smooth to the first derivative,
// increasing.
float soft_limit(float x);

// Pascals in, full scale out; `out` may be `pascals`. A sample that is not a number becomes silence.
void to_full_scale(std::span<const float> pascals, std::span<float> out, const LevelOptions& options = {});

}  // namespace intaglio::sound
