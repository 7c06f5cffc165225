#include "report/spectrogram.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "report/svg_plot.h"

namespace intaglio::report {

namespace {

// Hann window, scaled so that the power of its frames is a mean square: the mean of Hann^2 is 3/8, so the sum
// over bins of |X|^2 / (n^2 3/8) is the windowed mean square; with a hop of n/4 the shifted Hann^2 add up to
// the constant 1.5, so that all samples count alike.
std::vector<float> hann(int n) {
  std::vector<float> window(std::size_t(n), 0.0F);
  for (int i = 0; i < n; ++i) {
    const double w = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * i / n);
    window[std::size_t(i)] = float(w / (n * std::sqrt(0.375)));
  }
  return window;
}

// The bins of one pixel row: a fraction between two bins, or a run of them.
struct Row {
  int first = 0, last = 0;
  float fraction = 0;  // towards first + 1, where a row is narrower than a bin
};

std::vector<Row> rows_of(const Spectrogram& s, const SpectrogramView& view, int height) {
  std::vector<Row> rows{};
  rows.resize(std::size_t(height));
  const auto bin_at = [&](double y) {
    const double hz = view.high_hz * std::pow(view.low_hz / view.high_hz, y / height);
    return std::clamp(hz / s.bin_hz(), 0.0, s.bins - 1.0);
  };
  for (int y = 0; y < height; ++y) {
    const double low = bin_at(y + 1), high = bin_at(y);
    Row& row = rows[std::size_t(y)];
    if (high - low < 1) {
      const double middle = 0.5 * (low + high);
      row.first = std::min(int(middle), s.bins - 2);
      row.last = row.first + 1;
      row.fraction = float(middle - row.first);
    } else {
      row.first = int(std::ceil(low));
      row.last = int(std::floor(high));
      row.fraction = -1;
    }
  }
  return rows;
}

float row_power(std::span<const float> frame, const Row& row) {
  const auto first = std::size_t(row.first), last = std::size_t(row.last);
  if (row.fraction >= 0) return frame[first] + row.fraction * (frame[last] - frame[first]);
  return *std::max_element(frame.begin() + row.first, frame.begin() + row.last + 1);
}

// The frames that one pixel column shows: at least the nearest; none past the last.
std::pair<int, int> frames_of(const Spectrogram& s, const SpectrogramView& view, int x, int width) {
  const double frames_per_column = view.duration / width * s.sample_rate / s.hop();
  const int first = Spectrogram::frames_before + int(std::lround(x * frames_per_column));
  const int next = Spectrogram::frames_before + int(std::lround((x + 1) * frames_per_column));
  const int last = std::max(first + 1, next);
  return {first, std::min(last, s.frames)};
}

}  // namespace

Spectrogram make_spectrogram(std::span<const float> audio, double sample_rate, int window) {
  Spectrogram s;
  s.window = window;
  s.sample_rate = sample_rate;
  s.bins = window / 2 + 1;
  if (audio.empty() || !(sample_rate > 0)) return s;
  const auto size = std::ptrdiff_t(audio.size());
  // Four windows cover each sample, including the first and the last: this keeps the energy.
  s.frames = Spectrogram::frames_before + int((size - 1) / s.hop()) + 3;
  s.power.reserve(std::size_t(s.frames) * std::size_t(s.bins));
  const std::vector<float> shape = hann(window);
  std::vector<float> samples(shape.size());
  std::vector<std::complex<float>> spectrum;
  Eigen::FFT<float> fft;
  fft.SetFlag(Eigen::FFT<float>::HalfSpectrum);
  for (int f = 0; f < s.frames; ++f) {
    const std::ptrdiff_t start = std::ptrdiff_t(f - Spectrogram::frames_before) * s.hop() - window / 2;
    for (int i = 0; i < window; ++i) {
      const std::ptrdiff_t at = start + i;
      const float value = at >= 0 && at < size ? audio[std::size_t(at)] : 0.0f;
      samples[std::size_t(i)] = std::isfinite(value) ? value * shape[std::size_t(i)] : 0.0f;
    }
    fft.fwd(spectrum, samples);
    for (int b = 0; b < s.bins; ++b) {
      const bool has_mirror_image = b > 0 && b < s.bins - 1;
      s.power.push_back((has_mirror_image ? 2.0f : 1.0f) * std::norm(spectrum[std::size_t(b)]));
    }
  }
  return s;
}

std::vector<double> mean_spectrum(const Spectrogram& s) {
  std::vector<double> mean(std::size_t(s.bins), 0.0);
  for (int f = 0; f < s.frames; ++f) {
    const std::span<const float> frame = s.frame(f);
    for (std::size_t b = 0; b < mean.size(); ++b) mean[b] += double(frame[b]) / s.frames;
  }
  return mean;
}

double level_db(double mean_square, double floor_db) {
  return mean_square > 0 ? std::max(floor_db, 10 * std::log10(mean_square)) : floor_db;
}

Image8 spectrogram_image(const Spectrogram& s, const SpectrogramView& view, int width, int height) {
  Image8 image(width, height, 3);
  const std::vector<Row> rows =
      s.frames > 0 ? rows_of(s, view, height) : std::vector<Row>(std::size_t(height));
  for (int x = 0; x < width; ++x) {
    const auto [first, last] = s.frames > 0 ? frames_of(s, view, x, width) : std::pair(0, 0);
    for (int y = 0; y < height; ++y) {
      float power = 0;
      for (int f = first; f < last; ++f) power = std::max(power, row_power(s.frame(f), rows[std::size_t(y)]));
      const double level = level_db(double(power), view.floor_db);
      const Rgb colour = magma((level - view.floor_db) / (view.top_db - view.floor_db));
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = colour[std::size_t(c)];
    }
  }
  return image;
}

namespace {

constexpr double low_hz = 20, high_hz = 20000;

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

std::pair<double, double> ModalSpectrum::energy_near_modes() const {
  double near = 0, all = 0, near_octaves = 0, all_octaves = 0;
  for (std::size_t b = 1; b < power_.size(); ++b) {
    const double hz = double(b) * bin_hz_;
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
  for (auto b = std::size_t(std::ceil(low / bin_hz_)); b < power_.size(); ++b) {
    const double hz = double(b) * bin_hz_;
    if (hz > high) break;
    const bool is_inside = std::abs(hz - mode) <= width_ * mode;
    if (!is_inside && near_mode(hz)) continue;
    (is_inside ? inside : beside) += power_[b];
    (is_inside ? inside_bins : beside_bins) += 1;
  }
  // A single bin may be a neighbour's side lobe.
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

}  // namespace intaglio::report
