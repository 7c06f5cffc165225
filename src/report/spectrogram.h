// A short-time power spectrum of audio, and its picture on a logarithmic frequency axis.
//
// Hann windows, a quarter of a window apart, centred on their time; the audio is zero-padded.
// Power is one-sided and scaled so that the spectrogram keeps the audio's energy (Parseval):
//   sum over frames and bins of power x hop = sum over samples of audio^2.
// Cost: about 20 us a frame of 2048; memory: 4 bytes a frame and bin, 0.35 MB a second at 44.1 kHz.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "intaglio/image.h"

namespace intaglio::report {

struct Spectrogram {
  static constexpr int frames_before = 1;  // before time 0, so that four windows cover the first sample

  int window = 0;          // samples, a power of two
  double sample_rate = 0;  // Hz
  int frames = 0;
  int bins = 0;              // window / 2 + 1
  std::vector<float> power;  // frames x bins, mean square in full-scale units

  int hop() const { return window / 4; }  // samples
  double bin_hz() const { return window > 0 ? sample_rate / window : 0; }
  // Centre time of a frame, s.
  double time(int frame) const { return (frame - frames_before) * hop() / sample_rate; }
  std::span<const float> frame(int index) const {
    return std::span(power).subspan(std::size_t(index) * std::size_t(bins), std::size_t(bins));
  }
};

// The same frame by frame, from samples that are added as they are made.
class SpectrumStream {
 public:
  // `frame` takes the power of each frame, in order.
  SpectrumStream(int window, std::function<void(std::span<const float>)> frame);
  SpectrumStream(const SpectrumStream&) = delete;
  SpectrumStream& operator=(const SpectrumStream&) = delete;
  ~SpectrumStream();

  // A sample that is not finite counts as silence.
  void add(float sample);
  // Adds the last frames: four windows cover each sample, which keeps the energy.
  void finish();

 private:
  struct Transform;
  void make_frame();

  std::unique_ptr<Transform> transform_;
  std::function<void(std::span<const float>)> frame_;
  std::size_t samples_ = 0, frames_ = 0;
  std::vector<float> held_;  // those of the next frame, so far
};

// Samples that are not finite count as silence. Empty without audio or with a rate that is not positive.
Spectrogram make_spectrogram(std::span<const float> audio, double sample_rate, int window = 2048);

// Power averaged over frames, one value a bin.
class MeanSpectrum {
 public:
  void add(std::span<const float> frame);
  std::vector<double> mean() const;

 private:
  std::vector<double> sum_;
  std::size_t frames_ = 0;
};
std::vector<double> mean_spectrum(const Spectrogram& spectrogram);

// Decibels of a mean square against full scale, never below `floor_db`.
double level_db(double mean_square, double floor_db);

// part / whole; NaN, which reports print as unknown, without a whole.
inline double ratio(double part, double whole) {
  return whole > 0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
}

// Axes and levels of the picture.
struct SpectrogramView {
  double duration = 1;     // s, left edge is time 0
  double low_hz = 50;      // bottom edge
  double high_hz = 20000;  // top edge; logarithmic in between
  double floor_db = -100;  // and below: the scale's first colour
  double top_db = -20;     // and above: its last
};

// The picture, from frames that are added as they are made. RGB, row 0 = high_hz.
//
// A pixel shows the maximum over the frames in its column and the bins in its row (interpolated where bins
// are farther apart than rows), so that no impact is lost between columns.
class SpectrogramPicture {
 public:
  // `view`: the axes; levels are chosen when it is drawn.
  SpectrogramPicture(double sample_rate, int window, const SpectrogramView& view, int width, int height);

  void add(std::span<const float> frame);
  // The largest power of a bin.
  float loudest() const { return loudest_; }
  Image8 image(double floor_db, double top_db) const;

 private:
  // The bins of one pixel row: a fraction between two bins, or a run of them.
  struct Row {
    int first = 0, last = 0;
    float fraction = 0;  // towards first + 1, where a row is narrower than a bin
  };
  static float row_power(std::span<const float> frame, const Row& row);
  // The frames that a pixel column shows: from first, before last; at least the nearest.
  std::pair<int, int> frames_of(int x) const;

  int width_, height_;
  double frames_per_column_;
  std::vector<Row> rows_;
  std::vector<float> power_;    // width x height
  int frame_ = 0, column_ = 0;  // the next frame, and the first column that shows it
  float loudest_ = 0;
};

Image8 spectrogram_image(const Spectrogram& spectrogram, const SpectrogramView& view, int width, int height);

// Measures how much of a sound's power lies at given modal frequencies.
//
// The mean spectrum of a sound, in bins from 0 Hz, and its expected modal frequencies (Hz, finite, positive).
// "Near" is within `width` of a frequency, as a fraction of it. NaN when undefined.
class ModalSpectrum {
 public:
  ModalSpectrum(std::vector<double> mean_power, double bin_hz, std::vector<double> modes, double width);

  bool near_mode(double hz) const;

  // Fraction of the energy between 20 Hz and 20 kHz that is near a mode; and the same for noise of equal
  // energy per octave, whose density is 1/f: sum of 1/f near a mode over the sum of all 1/f.
  std::pair<double, double> energy_near_modes() const;

  // Power density at a mode over that of its surroundings (one to three widths away, excluding other modes),
  // dB, ascending. Only isolated modes within 40 dB of the strongest.
  std::vector<double> contrasts_db() const;

 private:
  struct Prominence {
    double inside = 0, beside = 0;  // mean power of a bin
  };
  Prominence prominence(double mode) const;

  std::vector<double> modes_;  // ascending
  std::vector<double> power_;
  double bin_hz_;
  double width_;
};

}  // namespace intaglio::report
