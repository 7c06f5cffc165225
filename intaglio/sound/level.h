// Where loudness is decided: pascals at 1 m become full scale here, and nowhere else.
//
// 20 Pa peak (117 dB SPL) is full scale, so that a clap or a hammer blow fits; `gain_db` moves all of it. A
// soft limiter follows: it has no memory, passes everything below -3 dBFS untouched, bends smoothly above,
// and never reaches beyond 1. Pure, any thread, no allocation.
#pragma once

#include <span>

namespace intaglio::sound {

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
