#include "intaglio/sound/modal_bank.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "intaglio/sound/denormals.h"

namespace intaglio::sound {

ModalBank::ModalBank(const ModalModel& model, double sample_rate) {
  const double dt = 1 / sample_rate;
  const double limit = 0.95 * std::numbers::pi * sample_rate;
  while (modes_ < model.modes() && model.angular_frequency[std::size_t(modes_)] < limit) ++modes_;
  groups_.resize(std::size_t((modes_ + lanes - 1) / lanes));
  for (int m = 0; m < modes_; ++m) {
    Group& group = groups_[std::size_t(m / lanes)];
    const int lane = m % lanes;
    const auto mode = static_cast<std::size_t>(m);
    const double omega = model.angular_frequency[mode], d = model.damping[mode];
    const double omega_d = std::sqrt(omega * omega - d * d);
    group.turn_re[lane] = static_cast<float>(std::exp(-d * dt) * std::cos(omega_d * dt));
    group.turn_im[lane] = static_cast<float>(std::exp(-d * dt) * std::sin(omega_d * dt));
    group.weight_re[lane] = static_cast<float>(model.radiation[mode]);
    group.weight_im[lane] = static_cast<float>(-model.radiation[mode] * d / omega_d);
  }
}

// Sums what the drives give to one group of modes; false when that is nothing.
bool ModalBank::gather(std::span<const Drive> drives, std::size_t first_mode, DriveBlock& block) {
  if (drives.empty()) return false;
  for (Lanes& at : block) at.setZero();
  for (const Drive& drive : drives) {
    const Lanes gain = Eigen::Map<const Lanes>(drive.gains.data() + first_mode);
    for (std::size_t k = 0; k < drive.impulse.size(); ++k)
      block[std::size_t(drive.first) + k] += gain * drive.impulse[k];
  }
  return true;
}

void ModalBank::ring(Group& group, const DriveBlock* drive, DriveBlock& sum, std::size_t samples) {
  // Copies, because a store to `sum` might for all the compiler knows change the group.
  const Lanes turn_re = group.turn_re, turn_im = group.turn_im;
  const Lanes weight_re = group.weight_re, weight_im = group.weight_im;
  Lanes re = group.re, im = group.im;
  for (std::size_t n = 0; n < samples; ++n) {
    const Lanes before = re;
    re = turn_re * re - turn_im * im;
    im = turn_re * im + turn_im * before;
    if (drive) re += (*drive)[n];
    sum[n] += weight_re * re + weight_im * im;
  }
  group.re = re;
  group.im = im;
}

void ModalBank::process(std::span<const Drive> drives, std::span<float> out) {
  assert(out.size() <= block_samples);
  const DenormalsAreZero guard;
  DriveBlock drive, sum;
  for (Lanes& at : sum) at.setZero();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const bool is_driven = gather(drives, g * lanes, drive);
    if (!is_driven && !groups_[g].is_awake) continue;
    groups_[g].is_awake = true;
    ring(groups_[g], is_driven ? &drive : nullptr, sum, out.size());
  }
  for (std::size_t n = 0; n < out.size(); ++n) out[n] += sum[n].sum();
}

void ModalBank::sleep_when_silent() {
  for (Group& group : groups_) {
    if (!group.is_awake) continue;
    const Lanes weight = group.weight_re.abs() + group.weight_im.abs();
    const float loudest = (weight * (group.re.abs() + group.im.abs())).maxCoeff();
    if (loudest > silence_pascal) continue;
    group.re.setZero();
    group.im.setZero();
    group.is_awake = false;
  }
}

bool ModalBank::is_silent() const {
  return std::none_of(groups_.begin(), groups_.end(), [](const Group& group) { return group.is_awake; });
}

double ModalBank::energy() const {
  double sum = 0;
  for (const Group& group : groups_) {
    sum += 0.5 * (group.re.cast<double>().square() + group.im.cast<double>().square()).sum();
  }
  return sum;
}

void ModalBank::reset() {
  for (Group& group : groups_) {
    group.re.setZero();
    group.im.setZero();
    group.is_awake = false;
  }
}

}  // namespace intaglio::sound
