// Sounds for the tests of hearing: tones by their level, noise, silence around a sound.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/portable_math.h"

namespace intaglio::tests {

using Sound = std::vector<float>;

// A sine whose root mean square is `level` dB above 20 micropascal.
inline Sound tone(double frequency, double level, double seconds, double rate = 48000) {
  Sound sound(std::size_t(std::llround(seconds * rate)));
  const double amplitude = std::numbers::sqrt2 * 2e-5 * std::pow(10, level / 20);
  for (std::size_t n = 0; n < sound.size(); ++n)
    sound[n] = float(amplitude * std::sin(2 * std::numbers::pi * frequency * double(n) / rate));
  return sound;
}

// Normal values, white up to half the rate; the root mean square is `deviation`.
inline Sound white_noise(double deviation, double seconds, std::uint64_t seed, double rate = 48000) {
  Random random(seed);
  Sound sound(std::size_t(std::llround(seconds * rate)));
  for (float& sample : sound) sample = float(deviation * random.normal());
  return sound;
}

inline Sound between_silence(double before, const Sound& sound, double after, double rate = 48000) {
  Sound all(std::size_t(std::llround(before * rate)), 0.0F);
  all.insert(all.end(), sound.begin(), sound.end());
  all.insert(all.end(), std::size_t(std::llround(after * rate)), 0.0F);
  return all;
}

inline Sound scaled(Sound sound, double gain) {
  for (float& sample : sound) sample = float(gain * double(sample));
  return sound;
}

}  // namespace intaglio::tests
