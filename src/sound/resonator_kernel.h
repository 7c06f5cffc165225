// The inner loop of the modal bank: damped resonators in coupled form, sixteen side by side, using the widest
// SIMD instructions available.
//
// Internal to sound/. A group is sixteen complex numbers z that are rotated and scaled each sample,
//   z <- turn z + sum over drives of (drive gain) impulse,
// already scaled so that the output is the sum of their real parts. Highway chooses the instructions at run
// time. No multiplication is fused with an addition and the sixteen lanes are added in one order, so every
// target gives the same bits. Real-time: no allocation, no lock. Cost: see bench/sound.cpp.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace intaglio::sound {

inline constexpr int block_samples = 64;
inline constexpr int resonator_lanes = 16;

// Impulses that arrive during a block: sample first + k receives gains[m] * impulse[k] in mode m.
struct Drive {
  std::span<const float> gains;    // of all groups: resonator_lanes each
  std::span<const float> impulse;  // N s per sample
  int first = 0;
};

struct alignas(64) ResonatorGroup {
  using Lanes = float[resonator_lanes];
  Lanes re{}, im{};              // z
  Lanes turn_re{}, turn_im{};    // e^((-d + i omega_d) dt)
  Lanes drive_re{}, drive_im{};  // z for a gain and impulse of 1
};

// Advances groups[k] for each k of `awake`, ascending, by `samples` (at most block_samples), and adds the
// real parts to `sum`: resonator_lanes for each sample, 64-byte aligned.
void ring(std::span<ResonatorGroup> groups, std::span<const int> awake, std::span<const Drive> drives,
          int samples, float* sum);

// The instruction sets that this build has and this machine can run, best first; and a way to select one, for
// tests and benchmarks. Selecting is not thread-safe.
std::vector<std::string> ring_targets();
void use_ring_target(const std::string& name);
void use_best_ring_target();

}  // namespace intaglio::sound
