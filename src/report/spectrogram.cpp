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

}  // namespace

struct SpectrumStream::Transform {
  std::vector<float> shape, samples, power;
  std::vector<std::complex<float>> spectrum = {};
  Eigen::FFT<float> fft = {};
};

SpectrumStream::SpectrumStream(int window, std::function<void(std::span<const float>)> frame)
    : transform_(std::make_unique<Transform>(Transform{hann(window), {}, {}})), frame_(std::move(frame)) {
  transform_->samples.resize(std::size_t(window));
  transform_->power.resize(std::size_t(window / 2 + 1));
  transform_->fft.SetFlag(Eigen::FFT<float>::HalfSpectrum);
  // The first frame is centred a hop before time 0.
  held_.reserve(std::size_t(window));
  held_.assign(std::size_t(window / 2 + Spectrogram::frames_before * (window / 4)), 0.0F);
}
SpectrumStream::~SpectrumStream() = default;

void SpectrumStream::add(float sample) {
  ++samples_;
  held_.push_back(sample);
  if (held_.size() == transform_->shape.size()) make_frame();
}

void SpectrumStream::make_frame() {
  auto& [shape, samples, power, spectrum, fft] = *transform_;
  for (std::size_t i = 0; i < shape.size(); ++i)
    samples[i] = std::isfinite(held_[i]) ? held_[i] * shape[i] : 0.0f;
  fft.fwd(spectrum, samples);
  for (std::size_t b = 0; b < power.size(); ++b) {
    const bool has_mirror_image = b > 0 && b + 1 < power.size();
    power[b] = (has_mirror_image ? 2.0f : 1.0f) * std::norm(spectrum[b]);
  }
  held_.erase(held_.begin(), held_.begin() + std::ptrdiff_t(shape.size() / 4));
  ++frames_;
  frame_(power);
}

void SpectrumStream::finish() {
  if (samples_ == 0) return;
  const std::size_t hop = transform_->shape.size() / 4;
  const std::size_t frames = Spectrogram::frames_before + (samples_ - 1) / hop + 3;
  while (frames_ < frames) {
    held_.resize(transform_->shape.size(), 0.0F);
    make_frame();
  }
}

Spectrogram make_spectrogram(std::span<const float> audio, double sample_rate, int window) {
  Spectrogram s;
  s.window = window;
  s.sample_rate = sample_rate;
  s.bins = window / 2 + 1;
  if (audio.empty() || !(sample_rate > 0)) return s;
  SpectrumStream stream(window, [&](std::span<const float> frame) {
    s.power.insert(s.power.end(), frame.begin(), frame.end());
    ++s.frames;
  });
  for (const float sample : audio) stream.add(sample);
  stream.finish();
  return s;
}

void MeanSpectrum::add(std::span<const float> frame) {
  sum_.resize(frame.size());
  for (std::size_t b = 0; b < frame.size(); ++b) sum_[b] += double(frame[b]);
  ++frames_;
}

std::vector<double> MeanSpectrum::mean() const {
  std::vector<double> mean = sum_;
  for (double& power : mean) power /= double(frames_);
  return mean;
}

std::vector<double> mean_spectrum(const Spectrogram& s) {
  MeanSpectrum mean;
  for (int f = 0; f < s.frames; ++f) mean.add(s.frame(f));
  return mean.mean();
}

double level_db(double mean_square, double floor_db) {
  return mean_square > 0 ? std::max(floor_db, 10 * std::log10(mean_square)) : floor_db;
}

SpectrogramPicture::SpectrogramPicture(double sample_rate, int window, const SpectrogramView& view, int width,
                                       int height)
    : width_(width),
      height_(height),
      frames_per_column_(view.duration / width * sample_rate / (window / 4)),
      rows_(std::size_t(height)),
      power_(std::size_t(width) * std::size_t(height), 0.0F) {
  const int bins = window / 2 + 1;
  const auto bin_at = [&](double y) {
    const double hz = view.high_hz * std::pow(view.low_hz / view.high_hz, y / height);
    return std::clamp(hz / (sample_rate / window), 0.0, bins - 1.0);
  };
  for (int y = 0; y < height; ++y) {
    const double low = bin_at(y + 1), high = bin_at(y);
    Row& row = rows_[std::size_t(y)];
    if (high - low < 1) {
      const double middle = 0.5 * (low + high);
      row.first = std::min(int(middle), bins - 2);
      row.last = row.first + 1;
      row.fraction = float(middle - row.first);
    } else {
      row.first = int(std::ceil(low));
      row.last = int(std::floor(high));
      row.fraction = -1;
    }
  }
}

float SpectrogramPicture::row_power(std::span<const float> frame, const Row& row) {
  const auto first = std::size_t(row.first), last = std::size_t(row.last);
  if (row.fraction >= 0) return frame[first] + row.fraction * (frame[last] - frame[first]);
  return *std::max_element(frame.begin() + row.first, frame.begin() + row.last + 1);
}

std::pair<int, int> SpectrogramPicture::frames_of(int x) const {
  const int first = Spectrogram::frames_before + int(std::lround(x * frames_per_column_));
  const int next = Spectrogram::frames_before + int(std::lround((x + 1) * frames_per_column_));
  return {first, std::max(first + 1, next)};
}

void SpectrogramPicture::add(std::span<const float> frame) {
  loudest_ = std::max(loudest_, *std::max_element(frame.begin(), frame.end()));
  while (column_ < width_ && frames_of(column_).second <= frame_) ++column_;
  for (int x = column_; x < width_ && frames_of(x).first <= frame_; ++x) {
    for (int y = 0; y < height_; ++y) {
      float& power = power_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
      power = std::max(power, row_power(frame, rows_[std::size_t(y)]));
    }
  }
  ++frame_;
}

Image8 SpectrogramPicture::image(double floor_db, double top_db) const {
  Image8 image(width_, height_, 3);
  for (std::size_t k = 0; k < power_.size(); ++k) {
    const double level = level_db(double(power_[k]), floor_db);
    const Rgb colour = magma((level - floor_db) / (top_db - floor_db));
    std::copy(colour.begin(), colour.end(), image.data.begin() + std::ptrdiff_t(3 * k));
  }
  return image;
}

Image8 spectrogram_image(const Spectrogram& s, const SpectrogramView& view, int width, int height) {
  SpectrogramPicture picture(s.sample_rate, s.window, view, width, height);
  for (int f = 0; f < s.frames; ++f) picture.add(s.frame(f));
  return picture.image(view.floor_db, view.top_db);
}

namespace {

constexpr double low_hz = 20, high_hz = 20000;

}  // namespace

ModalSpectrum::ModalSpectrum(std::vector<double> mean_power, double bin_hz, std::vector<double> modes,
                             double width)
    : modes_(std::move(modes)), power_(std::move(mean_power)), bin_hz_(bin_hz), width_(width) {
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
