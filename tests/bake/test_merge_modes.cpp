// Laws of merging modes: nothing is merged at 0, the stated error holds in rendered audio, audible modes
// stay.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/FFT>

#include "core/portable_math.h"
#include "sound/bake/merge_modes.h"
#include "sound/model_file.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::any_direction;
using test::model_of;
using test::struck;
using test::tau;

namespace {

using test::rate;

// Energy of a recording behind each auditory filter, Pa^2 s.
std::vector<double> heard_energy(const std::vector<float>& x, const std::vector<double>& centres) {
  Eigen::FFT<float> fft;
  std::vector<std::complex<float>> spectrum;
  fft.fwd(spectrum, x);
  std::vector<double> energy(centres.size(), 0.0);
  for (std::size_t k = 1; k < x.size() / 2; ++k) {
    const double hertz = double(k) * rate / double(x.size());
    const double power = 2 * double(std::norm(spectrum[k])) / double(x.size()) / rate;
    for (std::size_t b = 0; b < centres.size(); ++b)
      energy[b] += power * auditory_response(hertz, centres[b]);
  }
  return energy;
}

// Enough modes to fill bands, all decayed within a second.
const ModalModel& plastic_slab() {
  static const ModalModel model =
      bake(box({0.4, 0.012, 0.4}, 12, 1, 12), *find_material("plastic"), {"slab", {80, 20, 15'000}}).value();
  return model;
}

}  // namespace

TEST_CASE("merging with 0 dB leaves the model the same to the bit") {
  ModalModel model = plastic_slab();
  merge_modes(model, 0);
  CHECK(model_bytes(model) == model_bytes(plastic_slab()));
  CHECK(model.modes_before_merging == 0);
}

TEST_CASE("the computed energy in a band is that of rendered audio") {
  const ModalModel& model = plastic_slab();
  const AudibleModes modes = audible_modes(model);
  const std::vector<double> centres = band_centres(modes);
  Random random(1);
  double worst = 0;
  std::vector<std::vector<Mat3>> exact;
  for (const double centre : centres) exact.push_back(band_energy(modes, centre));
  for (int trial = 0; trial < 12; ++trial) {
    const int point = int(random.uniform(0, double(model.points.size()) - 1));
    const Vec3 n = any_direction(random);
    const std::vector<double> energy = heard_energy(struck(model, point, n, 65'536), centres);
    const double loudest = *std::max_element(energy.begin(), energy.end());
    for (std::size_t b = 0; b < centres.size(); ++b) {
      if (energy[b] < 0.1 * loudest) continue;  // there the skirts of louder modes are heard
      const double formula = n.dot(exact[b][std::size_t(point)] * n);
      worst = std::max(worst, std::abs(10 * std::log10(formula / energy[b])));
    }
  }
  MESSAGE("worst: " << worst << " dB");
  CHECK(worst < 0.8);
}

TEST_CASE("merging leaves fewer modes, and no band of rendered audio errs by more than is stated") {
  const ModalModel& before = plastic_slab();
  const AudibleModes modes = audible_modes(before);
  const std::vector<double> centres = band_centres(modes);
  std::vector<Mat3> floors;
  for (const double centre : centres) {
    Mat3 mean = Mat3::Zero();
    for (const Mat3& q : band_energy(modes, centre)) mean += q / double(before.points.size());
    floors.push_back(node_floor * mean);
  }
  int last = before.modes();
  for (const double allowed : {0.25, 0.5, 2.0}) {
    ModalModel merged = before;
    merge_modes(merged, allowed);
    CHECK(merged.modes() < before.modes());
    CHECK(merged.modes() <= last);
    last = merged.modes();
    CHECK(merged.modes_before_merging == before.modes());
    CHECK(merged.merge_error_db <= allowed);
    CHECK(merged.merge_error_rms_db <= merged.merge_error_db);
    CHECK(merged.merge_error_db > 0);
    Random random(2);
    double worst = 0;
    for (int trial = 0; trial < 20; ++trial) {
      const int point = int(random.uniform(0, double(before.points.size()) - 1));
      const Vec3 n = any_direction(random);
      const auto was = heard_energy(struck(before, point, n, 65'536), centres);
      const auto is = heard_energy(struck(merged, point, n, 65'536), centres);
      for (std::size_t b = 0; b < centres.size(); ++b) {
        const double floor = n.dot(floors[b] * n);
        worst = std::max(worst, std::abs(10 * std::log10((is[b] + floor) / (was[b] + floor))));
      }
    }
    MESSAGE(fmt::format(
        "{:.2f} dB allowed: {} of {} modes, {:.3f} dB stated ({:.3f} root mean square), {:.3f} "
        "dB measured",
        allowed, merged.modes(), before.modes(), merged.merge_error_db, merged.merge_error_rms_db, worst));
    CHECK(worst <= merged.merge_error_db);
  }
}

// Maximum share of a mode in the energy of its own band, over all points.
double loudest_share(const AudibleModes& modes, Eigen::Index m) {
  const std::vector<Mat3> all = band_energy(modes, modes.angular_frequency[m] / (2 * std::numbers::pi));
  double mean = 0, most = 0;
  for (const Mat3& q : all) mean += q.trace() / double(all.size());
  for (std::size_t p = 0; p < all.size(); ++p) {
    const double own = modes.gain.block<3, 1>(3 * Eigen::Index(p), m).squaredNorm() / (4 * modes.damping[m]);
    most = std::max(most, own / (all[p].trace() + node_floor * mean));
  }
  return most;
}

TEST_CASE("merging keeps every audible pitch within what is audible, and the model reads back") {
  for (const auto& model : {*test::small_ball(), *test::small_slab(), plastic_slab()}) {
    const AudibleModes heard = audible_modes(model);
    ModalModel merged = model;
    merge_modes(merged, 1);
    for (int m = 0; m < std::min(10, model.modes()); ++m) {
      double nearest = 1;
      for (const double omega : merged.angular_frequency)
        nearest = std::min(nearest, std::abs(omega / model.angular_frequency[std::size_t(m)] - 1));
      // The lowest modes of a small plate radiate so little that louder ones mask them.
      CHECK((nearest <= 0.002 || loudest_share(heard, m) < 0.01));
    }
    CHECK(std::is_sorted(merged.angular_frequency.begin(), merged.angular_frequency.end()));
    const auto back = parse_model(model_bytes(merged), "merged.modes");
    REQUIRE(back);
    CHECK(model_bytes(*back) == model_bytes(merged));
    CHECK(back->merge_error_db == merged.merge_error_db);
    CHECK(back->modes_before_merging == merged.modes_before_merging);
    CHECK(back->modes() == merged.modes());
  }
}

TEST_CASE("a ball's degenerate modes become one a group and sound the same, sample by sample") {
  const auto ball = test::small_ball();
  ModalModel merged = *ball;
  merge_modes(merged, 0.5);
  MESSAGE(ball->modes() << " modes become " << merged.modes());
  CHECK(merged.modes() <= ball->modes() / 3);
  Random random(3);
  double worst = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const int point = int(random.uniform(0, double(ball->points.size()) - 1));
    const Vec3 n = any_direction(random);
    const auto was = struck(*ball, point, n, 8192), is = struck(merged, point, n, 8192);
    double difference = 0, power = 0;
    for (std::size_t k = 0; k < was.size(); ++k) {
      difference += std::pow(double(was[k]) - double(is[k]), 2);
      power += std::pow(double(was[k]), 2);
    }
    worst = std::max(worst, difference / power);
  }
  MESSAGE("differs by " << worst << " of its power at most");
  CHECK(worst < 1e-3);
}

TEST_CASE("modes that beat are left alone, modes that do not are merged, masked ones are dropped") {
  const auto after = [](std::vector<double> hertz, std::vector<double> damping,
                        std::vector<double> loudness) {
    ModalModel model = model_of(hertz, damping);
    model.material.rayleigh_alpha = 2 * damping[0];
    model.material.rayleigh_beta = 0;
    model.radiation = loudness;
    merge_modes(model, 0.5);
    return model.modes();
  };
  CHECK(after({1000, 1001}, {1, 1}, {1, 1}) == 2);        // a second's beat, heard for seconds
  CHECK(after({1000, 1000.1}, {20, 20}, {1, 1}) == 1);    // decayed before it beats
  CHECK(after({1000, 1030}, {1000, 1000}, {1, 1}) == 2);  // short, but another pitch
  CHECK(after({1000, 1010}, {1, 1}, {1, 0.01}) == 1);     // 40 dB below in one band
  CHECK(after({1000, 4000}, {1, 1}, {1, 0.01}) == 2);     // the same, alone in its band
}
