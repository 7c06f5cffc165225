// The ringing of one body in real time: a bank of damped resonators in coupled form, one per mode.
//
// Each mode is a complex number z that is rotated and scaled every sample,
//   z <- e^((-d + i omega_d) dt) z + gain * impulse,
// where `impulse` (N s) is the impulse delivered within the sample. The exact modal velocity is
//   Re z - (d / omega_d) Im z,
// and the output the sum of these times the model's radiation weights: Pa at 1 m. Stored is the product w z,
// with the complex weight w that makes the output the real part. In 32-bit floats this form stays in tune
// where the direct form is off by cents at 20 Hz. One thread; process() neither allocates, locks nor throws,
// and its bits depend neither on how the output is divided into blocks nor on the processor's instructions
// (resonator_kernel.h). Cost with AVX-512: 0.14 ns per mode and sample in banks of 100; modes that have
// decayed below hearing are put to sleep in groups and cost nothing. Source: Mathews & Smith, "Methods for
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
  // The modes of a model below the bank's frequency limit.
  static std::vector<Resonator> resonators(const ModalModel& model, double sample_rate);

  int modes() const { return modes_; }
  // Number of gains of a Drive: modes() rounded up to whole groups; those beyond modes() must be 0.
  int padded_modes() const { return groups() * resonator_lanes; }
  int groups() const { return int(groups_.size()); }

  // Adds the next out.size() samples, at most block_samples, to `out`.
  void process(std::span<const Drive> drives, std::span<float> out);
  // Puts inaudible groups of modes to sleep. Call at a fixed interval, after process().
  void sleep_when_silent();

  bool is_silent() const { return awake_.empty(); }
  // Groups that ring and are not being faded out.
  int sounding_groups() const;
  bool is_sounding(int group) const {
    return is_awake_[std::size_t(group)] && !is_fading_[std::size_t(group)];
  }
  // Upper bound of the group's output, Pa at 1 m.
  float loudness(int group) const;
  // Fades the group out in about 20 ms (voice stealing).
  void fade(int group);

  // Half the sum of |z|^2 over the modes that radiate: their mechanical energy, J.
  double energy() const;
  void reset();

 private:
  struct Rotation {
    ResonatorGroup::Lanes re, im;
  };
  void silence(int group);

  double sample_rate_;
  std::vector<ResonatorGroup> groups_;
  std::vector<Rotation> rotations_;  // of the groups while they do not fade
  std::vector<int> awake_, all_;     // indices of groups, ascending
  std::vector<char> is_awake_, is_fading_;
  std::vector<double> unweighted_;  // 1 / |w|^2 of each mode
  int modes_ = 0;
};

// The click of a struck body: its rigid acceleration radiates a short pulse in addition to its ringing.
//
// Pure. A body of surface `area` is treated as a sphere of that area, radius a. The far-field pressure of an
// accelerating sphere (a dipole of finite ka) is its acceleration through a damped resonance,
//   p(s) / A(s) = rho c a cos(angle) s / ((s + c/a)^2 + (c/a)^2)   at 1 m,
// which is one more resonator of a modal bank: undamped angular frequency sqrt(2) c/a, damping c/a, modal
// velocity the body's own, radiation rho c a. An impulse J moves it by J / mass. cos(angle) is taken as its
// root mean square over all directions, 1 / sqrt(3). Source: Morse & Ingard, "Theoretical Acoustics", §7.2;
// Chadwick, Zheng, James, "Precomputed acceleration noise for improved rigid-body sound", 2012.

Resonator acceleration_noise(double area);
// Excitation gain of a unit impulse: 1 / (sqrt(3) mass).
double acceleration_gain(double mass);

}  // namespace intaglio::sound
