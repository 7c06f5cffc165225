#include "evaluate/power_spectrum.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace intaglio::evaluate {

std::size_t power_of_two_from(std::size_t count) {
  return std::bit_ceil(count);
}

PowerSpectrum::PowerSpectrum(std::size_t length)
    : transform_(int(length), false), in_(length), out_(length), power_(length / 2 + 1) {
  assert(length >= 2 && std::has_single_bit(length));
}

std::span<const double> PowerSpectrum::operator()(std::span<const double> values) {
  assert(values.size() <= in_.size());
  std::fill(in_.begin(), in_.end(), Complex(0));
  std::copy(values.begin(), values.end(), in_.begin());
  transform_(out_.data(), in_.data());
  const std::size_t half = in_.size() / 2;
  for (std::size_t k = 0; k <= half; ++k) {
    const double both = k == 0 || k == half ? 1 : 2;
    power_[k] = both * std::norm(out_[k]) / double(in_.size());
  }
  return power_;
}

}  // namespace intaglio::evaluate
