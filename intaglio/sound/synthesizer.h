// From contact events to sound: pascals at 1 m, sample by sample.
//
// Feed it events, then ask for the samples. Both bodies of a pair ring: `body` is struck by the blow, `other`
// by its opposite. What a contact sounds like has three levels (§1.2.5.1):
//
// - macro, the first touch: the impulse of its step as one Hertz half-sine in the middle of the step.
// - meso, while contact lasts: the engine's impulses (§1.3.3), of which only what is new strikes (see
//   contact_force.h), each where within its step the contact crossed the sharpest bend of a texture; or
//   Eq. 1.4 at every texel that the contact crosses (meso.h); or Eq. 1.4 sample by sample with the slope of
//   the height under the contact patch (rubbing.h). Of both bodies, where both have textures: a ball that
//   rolls sweeps over its own as fast as over the floor's; what is dragged sweeps over the floor's only.
// - micro, while contact lasts: fractal noise of both surfaces by the distance swept over each, level by
//   normal force (rubbing.h).
//
// A free body that is struck also clicks: its sudden acceleration pushes the air (acceleration_noise.h).
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
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "intaglio/core/event.h"
#include "intaglio/sound/listener.h"
#include "intaglio/sound/modal_model.h"
#include "intaglio/surface/surface.h"

namespace intaglio::sound {

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

}  // namespace intaglio::sound
