#include "intaglio/sound/band_energy.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace intaglio::sound {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double heard = 1e-5;          // of a filter's response: less is not in the band
constexpr double farthest = 10;         // bandwidths: resonances beyond are not in the band either
constexpr double least_content = 1e-6;  // of the strongest band, of its mean energy: less is no sound

// The filter's power that many bandwidths from its centre.
double rounded_exponential(double bandwidths) {
  return (1 + 4 * bandwidths) * std::exp(-4 * bandwidths);
}

constexpr std::array places{0.0, 0.05, 0.1,  0.15, 0.2, 0.3, 0.4, 0.5, 0.65,
                            0.8, 1.0,  1.25, 1.5,  2.0, 2.5, 3.0, 4.0};

// What the filter passes of a resonance 1 / (d + i (w - omega)): the integral over all w, over pi. Exact for
// the response drawn straight between some places, which is nowhere negative, so that no energy will be.
std::complex<double> passed(double omega, double d, double centre) {
  static const auto responses = [] {
    std::array<double, places.size()> all{};
    std::transform(places.begin(), places.end(), all.begin(), rounded_exponential);
    return all;
  }();
  const double width = 2 * std::numbers::pi * erb(centre);
  const std::complex<double> i(0, 1);
  std::complex<double> sum = 0;
  for (const double side : {-1.0, 1.0}) {
    const double middle = 2 * std::numbers::pi * centre - omega;
    std::complex<double> log_from = std::log(std::complex(d, middle));
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
      const double from = middle + side * places[k] * width,
                   along = side * (places[k + 1] - places[k]) * width;
      const double slope = (responses[k + 1] - responses[k]) / along;
      // response + slope (x - from) over z = d + i x.
      const std::complex<double> log_to = std::log(std::complex(d, from + along));
      sum += side * (-i * std::complex(responses[k] - slope * from, slope * d) * (log_to - log_from) -
                     slope * along * i);
      log_from = log_to;
    }
  }
  return sum / std::numbers::pi;
}

double decibels(double ratio) {
  return 10 * std::log10(ratio);
}

// The worst |dB| of n^T after n over n^T before n.
double worst_direction(const Mat3& after, const Mat3& before) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Mat3> solver(after, before,
                                                              Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  return std::max(std::abs(decibels(std::max(1e-30, solver.eigenvalues()[0]))),
                  std::abs(decibels(std::max(1e-30, solver.eigenvalues()[2]))));
}

}  // namespace

double erb(double hertz) {
  return 24.7 * (4.37e-3 * hertz + 1);
}

double erb_number(double hertz) {
  return 21.4 * std::log10(4.37e-3 * hertz + 1);
}

double hertz_at_erb(double number) {
  return (std::pow(10.0, number / 21.4) - 1) / 4.37e-3;
}

double auditory_response(double hertz, double centre) {
  return rounded_exponential(std::abs(hertz - centre) / erb(centre));
}

HeardModes heard_modes(const ModalModel& model, int stride) {
  HeardModes heard_ones;
  const Index modes = model.modes(), points = (Index(model.points.size()) + stride - 1) / stride;
  heard_ones.angular_frequency = Eigen::Map<const Eigen::VectorXd>(model.angular_frequency.data(), modes);
  heard_ones.damping = Eigen::Map<const Eigen::VectorXd>(model.damping.data(), modes);
  heard_ones.gain.resize(3 * points, modes);
  for (Index p = 0; p < points; ++p) {
    for (Index m = 0; m < modes; ++m)
      heard_ones.gain.block<3, 1>(3 * p, m) =
          model.radiation[std::size_t(m)] * model.shape(int(p) * stride, int(m));
  }
  return heard_ones;
}

std::vector<double> band_centres(const HeardModes& modes) {
  std::vector<double> centres;
  if (modes.modes() == 0) return centres;
  const double first = erb_number(modes.angular_frequency.minCoeff() / (2 * std::numbers::pi));
  const double last = erb_number(modes.angular_frequency.maxCoeff() / (2 * std::numbers::pi));
  for (double number = std::round(first); number <= std::round(last); ++number)
    centres.push_back(hertz_at_erb(number));
  return centres;
}

std::vector<Mat3> band_energy(const HeardModes& modes, double centre) {
  std::vector<Index> in_band;
  std::vector<std::complex<double>> resonance;
  for (Index m = 0; m < modes.modes(); ++m) {
    if (std::abs(modes.angular_frequency[m] / (2 * std::numbers::pi) - centre) > farthest * erb(centre))
      continue;
    const auto h = passed(modes.angular_frequency[m], modes.damping[m], centre);
    if (std::abs(h) < heard) continue;
    in_band.push_back(m);
    resonance.push_back(h);
  }
  const Index count = Index(in_band.size());
  MatrixXd pairs(count, count), gain(modes.gain.rows(), count);
  for (Index i = 0; i < count; ++i) {
    const Index a = in_band[std::size_t(i)];
    gain.col(i) = modes.gain.col(a);
    for (Index k = 0; k < count; ++k) {
      // A product of two resonances is their sum over the sum of their denominators.
      const Index b = in_band[std::size_t(k)];
      const std::complex<double> both(modes.damping[a] + modes.damping[b],
                                      modes.angular_frequency[b] - modes.angular_frequency[a]);
      const std::complex<double> sum = resonance[std::size_t(i)] + std::conj(resonance[std::size_t(k)]);
      pairs(i, k) = 0.25 * (sum.real() * both.real() + sum.imag() * both.imag()) / std::norm(both);
    }
  }
  const MatrixXd half = gain * pairs;
  std::vector<Mat3> energy(std::size_t(modes.points()), Mat3::Zero());
  for (Index p = 0; p < modes.points() && count > 0; ++p)
    energy[std::size_t(p)] = half.middleRows<3>(3 * p) * gain.middleRows<3>(3 * p).transpose();
  return energy;
}

std::vector<Band> bands_of(const HeardModes& modes) {
  std::vector<Band> bands;
  double strongest = 0;
  for (const double centre : band_centres(modes)) {
    bands.push_back({centre, band_energy(modes, centre), Mat3::Zero()});
    Band& band = bands.back();
    for (const Mat3& q : band.energy) band.mean += q / double(band.energy.size());
    strongest = std::max(strongest, band.mean.trace());
  }
  std::erase_if(bands, [&](const Band& b) { return !(b.mean.trace() > least_content * strongest); });
  return bands;
}

SpectralError spectral_error(std::span<const Band> before, const HeardModes& after) {
  SpectralError error;
  double squares = 0;
  std::size_t count = 0;
  for (const Band& band : before) {
    const std::vector<Mat3> energy = band_energy(after, band.centre);
    // A direction in which the band has nothing at all anywhere is none to divide by.
    const Mat3 floor = node_share * band.mean + 1e-9 * band.mean.trace() * Mat3::Identity();
    for (std::size_t p = 0; p < energy.size(); ++p) {
      const Mat3 was = band.energy[p] + floor, is = energy[p] + floor;
      error.max_db = std::max(error.max_db, worst_direction(is, was));
      squares += std::pow(decibels(is.trace() / was.trace()), 2);
      ++count;
    }
  }
  if (count > 0) error.rms_db = std::sqrt(squares / double(count));
  return error;
}

}  // namespace intaglio::sound
