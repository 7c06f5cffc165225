// How the power of a sound lies to a set of modal frequencies: near them, beside them, between them.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "intaglio/session/spectrogram.h"

namespace intaglio::session {

// The mean spectrum of a sound, with the frequencies (Hz, finite, positive) at which it ought to ring. "Near"
// is within `width` of a frequency, as a fraction of it. What cannot be told is not-a-number.
class ModalSpectrum {
 public:
  ModalSpectrum(const Spectrogram& spectrogram, std::vector<double> modes, double width);

  bool near_mode(double hz) const;

  // Fraction of the energy between 20 Hz and 20 kHz that is near a mode; and the same for noise of equal
  // energy an octave.
  std::pair<double, double> share() const;

  // dB by which the power density near a mode stands above that beside it, up to three widths away, where no
  // mode is. For modes that stand far enough apart to tell and lie within 40 dB of the strongest. Ascending.
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

}  // namespace intaglio::session
