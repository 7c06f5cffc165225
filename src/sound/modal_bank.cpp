#include "sound/modal_bank.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "core/portable_math.h"
#include "sound/denormals.h"
#include "sound/modal_model.h"

namespace intaglio::sound {

namespace {

constexpr double fade_time = 2e-3;  // s, time constant of a fade

// Adds the lanes in one order, whatever the processor: halves onto halves.
float sum_of(const float* lanes) {
  std::array<float, resonator_lanes> x;
  std::copy_n(lanes, resonator_lanes, x.begin());
  for (std::size_t half = resonator_lanes / 2; half > 0; half /= 2) {
    for (std::size_t k = 0; k < half; ++k) x[k] += x[k + half];
  }
  return x[0];
}

}  // namespace

std::vector<Resonator> ModalBank::resonators(const ModalModel& model, double sample_rate) {
  const double limit = 0.95 * std::numbers::pi * sample_rate;
  std::vector<Resonator> list;
  for (std::size_t m = 0; m < model.angular_frequency.size() && model.angular_frequency[m] < limit; ++m)
    list.push_back({model.angular_frequency[m], model.damping[m], model.radiation[m]});
  return list;
}

ModalBank::ModalBank(const ModalModel& model, double sample_rate)
    : ModalBank(resonators(model, sample_rate), sample_rate) {}

ModalBank::ModalBank(std::span<const Resonator> resonators, double sample_rate)
    : sample_rate_(sample_rate), modes_(int(resonators.size())) {
  const double dt = 1 / sample_rate;
  const std::size_t count = (resonators.size() + resonator_lanes - 1) / resonator_lanes;
  groups_.resize(count);
  rotations_.resize(count);
  is_awake_.resize(count);
  is_fading_.resize(count);
  all_.resize(count);
  awake_.reserve(count);
  std::iota(all_.begin(), all_.end(), 0);
  for (std::size_t m = 0; m < resonators.size(); ++m) {
    ResonatorGroup& group = groups_[m / resonator_lanes];
    const std::size_t lane = m % resonator_lanes;
    const double omega = resonators[m].angular_frequency, d = resonators[m].damping;
    const double radiation = resonators[m].radiation;
    const double omega_d = std::sqrt(omega * omega - d * d);
    const double decay = elementary::exp(-d * dt);
    const auto [sine, cosine] = elementary::sin_cos(omega_d * dt);
    group.turn_re[lane] = float(decay * cosine);
    group.turn_im[lane] = float(decay * sine);
    // w = radiation (1 + i d / omega_d), so that Re(w z) = radiation (Re z - d / omega_d Im z).
    group.drive_re[lane] = float(radiation);
    group.drive_im[lane] = float(radiation * d / omega_d);
    const double weight = radiation * radiation * (1 + d * d / (omega_d * omega_d));
    unweighted_.push_back(weight > 0 ? 1 / weight : 0);
  }
  for (std::size_t g = 0; g < count; ++g) {
    std::copy_n(groups_[g].turn_re, resonator_lanes, rotations_[g].re);
    std::copy_n(groups_[g].turn_im, resonator_lanes, rotations_[g].im);
  }
}

void ModalBank::process(std::span<const Drive> drives, std::span<float> out) {
  assert(out.size() <= block_samples);
  const DenormalsAreZero guard;
  if (!drives.empty() && awake_.size() < all_.size()) {
    awake_.assign(all_.begin(), all_.end());
    std::fill(is_awake_.begin(), is_awake_.end(), char{1});
  }
  if (awake_.empty()) return;
  alignas(64) std::array<float, block_samples * resonator_lanes> sum;
  std::fill_n(sum.begin(), out.size() * resonator_lanes, 0.0f);
  ring(groups_, awake_, drives, int(out.size()), sum.data());
  for (std::size_t n = 0; n < out.size(); ++n) out[n] += sum_of(&sum[n * resonator_lanes]);
}

float ModalBank::loudness(int group) const {
  const ResonatorGroup& g = groups_[std::size_t(group)];
  float most = 0;
  for (std::size_t lane = 0; lane < resonator_lanes; ++lane)
    most = std::max(most, std::abs(g.re[lane]) + std::abs(g.im[lane]));
  return most;
}

void ModalBank::silence(int group) {
  ResonatorGroup& g = groups_[std::size_t(group)];
  std::fill_n(g.re, resonator_lanes, 0.0f);
  std::fill_n(g.im, resonator_lanes, 0.0f);
  std::copy_n(rotations_[std::size_t(group)].re, resonator_lanes, g.turn_re);
  std::copy_n(rotations_[std::size_t(group)].im, resonator_lanes, g.turn_im);
  is_awake_[std::size_t(group)] = is_fading_[std::size_t(group)] = 0;
}

void ModalBank::sleep_when_silent() {
  const auto falls_asleep = [this](int group) {
    if (loudness(group) > silence_pascal) return false;
    silence(group);
    return true;
  };
  awake_.erase(std::remove_if(awake_.begin(), awake_.end(), falls_asleep), awake_.end());
}

int ModalBank::sounding_groups() const {
  return int(std::count_if(awake_.begin(), awake_.end(), [this](int g) { return is_sounding(g); }));
}

void ModalBank::fade(int group) {
  if (!is_sounding(group)) return;
  is_fading_[std::size_t(group)] = 1;
  const auto faster = float(elementary::exp(-1 / (fade_time * sample_rate_)));
  for (std::size_t lane = 0; lane < resonator_lanes; ++lane) {
    groups_[std::size_t(group)].turn_re[lane] *= faster;
    groups_[std::size_t(group)].turn_im[lane] *= faster;
  }
}

double ModalBank::energy() const {
  double sum = 0;
  for (std::size_t m = 0; m < unweighted_.size(); ++m) {
    const ResonatorGroup& group = groups_[m / resonator_lanes];
    const double re = group.re[m % resonator_lanes], im = group.im[m % resonator_lanes];
    sum += 0.5 * (re * re + im * im) * unweighted_[m];
  }
  return sum;
}

void ModalBank::reset() {
  for (const int group : all_) silence(group);
  awake_.clear();
}

Resonator acceleration_noise(double area) {
  const double radius = std::sqrt(area / (4 * std::numbers::pi));
  const double rate = speed_of_sound / radius;
  return {std::numbers::sqrt2 * rate, rate, air_density * speed_of_sound * radius};
}

double acceleration_gain(double mass) {
  return 1 / (std::sqrt(3.0) * mass);
}

}  // namespace intaglio::sound
