// Metrics have the same bits with every compiler.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include "core/bootstrap.h"
#include "core/hash.h"
#include "evaluate/flip.h"
#include "evaluate/loudness.h"
#include "evaluate/spectrum_distance.h"
#include "evaluate/vibration.h"
#include "tests/evaluate/sounds.h"

using namespace intaglio;
using namespace intaglio::evaluate;
using namespace intaglio::tests;

namespace {

std::string hash_of(std::span<const double> values) {
  Hash hash;
  hash.add(values);
  return fmt::format("{:016x}", hash.value());
}

}  // namespace

TEST_CASE("the metrics of seeded input have the same bits with every compiler") {
  Random random(1);
  Image8 one(61, 47, 3), other(61, 47, 3);
  for (Image8* picture : {&one, &other})
    for (auto& sample : picture->data) sample = std::uint8_t(random.uniform(0, 256));
  const FlipMap map = flip(one, other).value();
  const std::vector<double> errors(map.error.data.begin(), map.error.data.end());
  CHECK(hash_of(errors) == "4352317aafa86521");

  const Sound noise = white_noise(0.05, 0.4, 2), later = white_noise(0.05, 0.4, 3);
  const LoudnessTrace trace = loudness_over_time(noise, 44100);
  CHECK(hash_of(trace.sone) == "6f67fe596290b20d");
  CHECK(hash_of(trace.specific[7]) == "9f5f040af2704569");
  CHECK(hash_of(stationary_loudness(noise, 48000).specific) == "3328712f3289b386");
  const double distance = log_spectral_distance(noise, later, 48000);
  CHECK(hash_of({&distance, 1}) == "ae078c563ed50246");
  CHECK(hash_of(decay_times(between_silence(0, noise, 0.3), 48000)) == "538fc13812ac14e5");

  std::vector<double> force(1500);
  for (double& value : force) value = 1 + random.normal();
  CHECK(hash_of(vibration_energy(force, 1000).bands) == "bf5528c9aad37195");
  const VibrationIntensity intensity = vibration_intensity(displacement_of_force(force), 1000);
  CHECK(hash_of(std::array{intensity.pacinian, intensity.non_pacinian}) == "ada0dc7ff83517a8");
  const Interval interval = bootstrap_interval(force);
  CHECK(hash_of(std::array{interval.low, interval.high}) == "c7a47b0f59917f8c");
}
