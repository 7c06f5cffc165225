// The ringing of one body in real time: a bank of damped resonators in coupled form, one a mode.
//
// Each mode is a complex number z that turns and shrinks every sample,
//   z <- e^((-d + i omega_d) dt) z + gain * impulse,
// where `impulse` (N s) is what the drive gives within the sample. The exact modal velocity is
// Re z - (d / omega_d) Im z, and the output the sum of these times the model's radiation weights: Pa at 1 m.
// Stored is w z, with the complex weight w that makes the output the real part. In 32-bit floats this form
// stays in tune where the direct form is off by cents at 20 Hz. One thread; process() neither allocates,
// locks nor throws, and its bits do not depend on how blocks are cut nor on the processor's instructions
// (resonator_kernel.h). Cost with AVX-512: 0.14 ns a mode and sample in banks of 100; modes that have decayed
// below hearing are put to sleep in groups and cost nothing. Source: Mathews & Smith, "Methods for
// synthesizing very high Q parametrically well behaved two pole filters", 2003.
#pragma once

#include <span>
#include <vector>

#include "sound/modal_model.h"
#include "sound/resonator_kernel.h"

namespace intaglio::sound {

// A mode quieter than this is silent: 60 dB below the threshold of hearing at 1 m.
inline constexpr float silence_pascal = 2e-8f;

// One damped oscillation, as in ModalModel.
struct Resonator {
  double angular_frequency = 0;  // rad/s, of the undamped one
  double damping = 0;            // 1/s, below that
  double radiation = 1;          // Pa at 1 m for a modal velocity of 1
};

class ModalBank {
 public:
  ModalBank(std::span<const Resonator> resonators, double sample_rate);
  // Leaves out modes above 0.95 times half the sample rate.
  ModalBank(const ModalModel& model, double sample_rate);
  // The modes of a model that a bank of that rate plays.
  static std::vector<Resonator> resonators(const ModalModel& model, double sample_rate);

  int modes() const { return modes_; }
  // How many gains a Drive must bring: modes() rounded up to whole groups; those beyond modes() must be 0.
  int padded_modes() const { return groups() * resonator_lanes; }
  int groups() const { return static_cast<int>(groups_.size()); }

  // Adds the next out.size() samples, at most block_samples, to `out`.
  void process(std::span<const Drive> drives, std::span<float> out);
  // Puts groups of modes to sleep that have become inaudible. Call it at a fixed rhythm, after process().
  void sleep_when_silent();

  bool is_silent() const { return awake_.empty(); }
  // Groups that ring, and are not being silenced.
  int sounding_groups() const;
  bool is_sounding(int group) const {
    return is_awake_[std::size_t(group)] && !is_fading_[std::size_t(group)];
  }
  // At most that loud, Pa at 1 m.
  float loudness(int group) const;
  // Lets a group die away in some 20 ms, without a click: its place is needed.
  void fade(int group);

  // Half the sum of |z|^2 over the modes that radiate: their mechanical energy, J.
  double energy() const;
  void reset();

 private:
  struct Turn {
    ResonatorGroup::Lanes re, im;
  };
  void silence(int group);

  double sample_rate_;
  std::vector<ResonatorGroup> groups_;
  std::vector<Turn> turns_;       // of the groups while they do not fade
  std::vector<int> awake_, all_;  // indices of groups, ascending
  std::vector<char> is_awake_, is_fading_;
  std::vector<double> unweighted_;  // 1 / |w|^2 of each mode
  int modes_ = 0;
};

// The click of a body that is struck: its sudden acceleration as a whole pushes the air, before and beside
// its ringing.
//
// Pure. A body of surface `area` is taken as a sphere of that area, radius a. The far-field pressure of a
// sphere that accelerates (a dipole of finite ka) is its acceleration through a damped resonance,
//   p(s) / A(s) = rho c a cos(angle) s / ((s + c/a)^2 + (c/a)^2)   at 1 m,
// which is one more resonator of a modal bank: undamped angular frequency sqrt(2) c/a, damping c/a, modal
// velocity the body's own, radiation rho c a. An impulse J moves it by J / mass. cos(angle) is taken as its
// root mean square over all directions, 1 / sqrt(3). Source: Morse & Ingard, "Theoretical Acoustics", §7.2;
// Chadwick, Zheng, James, "Precomputed acceleration noise for improved rigid-body sound", 2012.

Resonator acceleration_noise(double area);
// What a unit impulse gives it: 1 / (sqrt(3) mass).
double acceleration_gain(double mass);

}  // namespace intaglio::sound
