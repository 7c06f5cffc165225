#include "intaglio/session/report_modes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace intaglio::session {

namespace {

constexpr double low_hz = 20, high_hz = 20000;

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

ModalSpectrum::ModalSpectrum(const Spectrogram& spectrogram, std::vector<double> modes, double width)
    : modes_(std::move(modes)),
      power_(mean_spectrum(spectrogram)),
      bin_hz_(spectrogram.bin_hz()),
      width_(width) {
  std::sort(modes_.begin(), modes_.end());
}

bool ModalSpectrum::near_mode(double hz) const {
  const auto mode = std::lower_bound(modes_.begin(), modes_.end(), hz / (1 + width_));
  return mode != modes_.end() && *mode * (1 - width_) <= hz;
}

std::pair<double, double> ModalSpectrum::share() const {
  double near = 0, all = 0, near_octaves = 0, all_octaves = 0;
  for (std::size_t b = 1; b < power_.size(); ++b) {
    const double hz = static_cast<double>(b) * bin_hz_;
    if (hz < low_hz || hz > high_hz) continue;
    all += power_[b];
    all_octaves += 1 / hz;
    if (!near_mode(hz)) continue;
    near += power_[b];
    near_octaves += 1 / hz;
  }
  return {ratio(near, all), ratio(near_octaves, all_octaves)};
}

ModalSpectrum::Prominence ModalSpectrum::prominence(double mode) const {
  double inside = 0, beside = 0, inside_bins = 0, beside_bins = 0;
  const double low = mode * (1 - 3 * width_), high = mode * (1 + 3 * width_);
  for (auto b = static_cast<std::size_t>(std::ceil(low / bin_hz_)); b < power_.size(); ++b) {
    const double hz = static_cast<double>(b) * bin_hz_;
    if (hz > high) break;
    const bool is_inside = std::abs(hz - mode) <= width_ * mode;
    if (!is_inside && near_mode(hz)) continue;
    (is_inside ? inside : beside) += power_[b];
    (is_inside ? inside_bins : beside_bins) += 1;
  }
  // One bin alone may be the skirt of a neighbour.
  return {ratio(inside, inside_bins), beside_bins > 1 ? beside / beside_bins : 0};
}

std::vector<double> ModalSpectrum::contrasts_db() const {
  std::vector<Prominence> found;
  double strongest = 0;
  for (const double mode : modes_) {
    if (mode < low_hz || mode > high_hz) continue;
    const Prominence p = prominence(mode);
    if (!(p.inside > 0)) continue;
    strongest = std::max(strongest, p.inside);
    if (p.beside > 0) found.push_back(p);
  }
  std::vector<double> contrasts;
  for (const Prominence& p : found) {
    if (p.inside > 1e-4 * strongest) contrasts.push_back(10 * std::log10(p.inside / p.beside));
  }
  std::sort(contrasts.begin(), contrasts.end());
  return contrasts;
}

}  // namespace intaglio::session
