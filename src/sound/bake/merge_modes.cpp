#include "sound/bake/merge_modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace intaglio::sound {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double slowest_beat = 0.5;  // distance of angular frequencies over the sum of both decays
constexpr double min_pitch_change = 0.002;
constexpr double masked_share = 0.01;  // of its band's energy
constexpr int sampled_points = 100;
constexpr double bands_reached = 4;  // a mode is audible in bands up to that far from it
// Rendered audio exceeds the formula by up to 1 % (tests/bake/test_merge_modes.cpp, "errs by more than is
// stated"); 5 % is added.
constexpr double safety_factor = 1.05;

// A group of modes to be merged.
struct Group {
  std::vector<int> members;  // by frequency
  double omega = 0;
  double weight = 0;  // radiated energy over the surface, of the sum if all have one frequency
};

class ModeMerger {
 public:
  ModeMerger(const ModalModel& model, double allowed_db)
      : model_(model),
        allowed_db_(allowed_db),
        audible_(audible_modes(model, 1 + int(model.points.size()) / sampled_points)),
        bands_(audible_bands(audible_)) {
    for (int m = 0; m < model.modes(); ++m)
      groups_.push_back({{m},
                         audible_.angular_frequency[m],
                         audible_.gain.col(m).squaredNorm() / std::max(1e-12, audible_.damping[m])});
  }

  void run() {
    merge_close();
    drop_masked();
  }
  const std::vector<Group>& groups() const { return groups_; }

  double damping(double omega) const { return rayleigh_damping(model_.material, omega); }

  // One mode per group.
  AudibleModes modes_of(std::span<const Group> groups) const {
    AudibleModes modes{Eigen::VectorXd(Index(groups.size())), Eigen::VectorXd(Index(groups.size())),
                       Eigen::MatrixXd::Zero(audible_.gain.rows(), Index(groups.size()))};
    for (std::size_t g = 0; g < groups.size(); ++g) {
      modes.angular_frequency[Index(g)] = groups[g].omega;
      modes.damping[Index(g)] = damping(groups[g].omega);
      for (const int m : groups[g].members) modes.gain.col(Index(g)) += audible_.gain.col(m);
    }
    return modes;
  }

 private:
  Group merged(const Group& a, const Group& b) const {
    Group both{a.members, 0, a.weight + b.weight};
    both.members.insert(both.members.end(), b.members.begin(), b.members.end());
    std::sort(both.members.begin(), both.members.end());
    const double share = both.weight > 0 ? b.weight / both.weight : 0.5;
    both.omega = a.omega + share * (b.omega - a.omega);
    // The energies of modes of equal frequency depend on their basis; that of their sum does not.
    if (a.omega == b.omega) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(audible_.gain.rows());
      for (const int m : both.members) sum += audible_.gain.col(m);
      both.weight = sum.squaredNorm() / std::max(1e-12, damping(both.omega));
    }
    return both;
  }

  // Audibility of merging two groups: above 1 it would be heard.
  double audibility(const Group& a, const Group& b) const {
    const Group both = merged(a, b);
    double most = 0;
    for (const int m : both.members) {
      const double omega = model_.angular_frequency[std::size_t(m)], apart = std::abs(omega - both.omega);
      most = std::max(most, apart / (min_pitch_change * omega));
    }
    const double span = model_.angular_frequency[std::size_t(both.members.back())] -
                        model_.angular_frequency[std::size_t(both.members.front())];
    return std::max(most, span / (slowest_beat * 2 * damping(both.omega)));
  }

  // Whether the bands near `omega` stay within the limit when groups_ become `changed`.
  bool is_allowed(const std::vector<Group>& changed, double omega) const {
    const double place = erb_number(omega / (2 * std::numbers::pi));
    const auto first = std::find_if(bands_.begin(), bands_.end(), [&](const Band& b) {
      return erb_number(b.centre) > place - bands_reached;
    });
    const auto end = std::find_if(
        first, bands_.end(), [&](const Band& b) { return erb_number(b.centre) >= place + bands_reached; });
    return spectral_error({first, end}, modes_of(changed)).max_db <= allowed_db_;
  }

  void merge_close() {
    std::vector<bool> refused(groups_.size(), false);  // of each group and the one above it
    for (;;) {
      std::size_t best = groups_.size();
      double least = 1;
      for (std::size_t g = 0; g + 1 < groups_.size(); ++g) {
        if (refused[g]) continue;
        const double d = audibility(groups_[g], groups_[g + 1]);
        if (d < least) {
          least = d;
          best = g;
        }
      }
      if (best == groups_.size()) return;
      std::vector<Group> changed = groups_;
      changed[best] = merged(groups_[best], groups_[best + 1]);
      changed.erase(changed.begin() + std::ptrdiff_t(best) + 1);
      if (!is_allowed(changed, changed[best].omega)) {
        refused[best] = true;
        continue;
      }
      groups_ = std::move(changed);
      refused.erase(refused.begin() + std::ptrdiff_t(best) + 1);
      refused[best] = false;
      if (best > 0) refused[best - 1] = false;
    }
  }

  // Maximum share of a mode in its band's energy over all points.
  double share(const AudibleModes& modes, Index m) const {
    const double centre = modes.angular_frequency[m] / (2 * std::numbers::pi);
    const std::vector<Mat3> all = band_energy(modes, centre);
    double mean = 0, most = 0;
    for (const Mat3& q : all) mean += q.trace() / double(all.size());
    for (Index p = 0; p < modes.points(); ++p) {
      const double own = modes.gain.block<3, 1>(3 * p, m).squaredNorm() / (4 * modes.damping[m]);
      most = std::max(most, own / (all[std::size_t(p)].trace() + node_floor * mean));
    }
    return most;
  }

  void drop_masked() {
    const AudibleModes modes = modes_of(groups_);
    std::vector<std::pair<double, int>> faint;  // share, first member
    for (Index g = 0; g < modes.modes(); ++g) {
      const double s = share(modes, g);
      if (s < masked_share) faint.emplace_back(s, groups_[std::size_t(g)].members.front());
    }
    std::sort(faint.begin(), faint.end());
    for (const auto& one : faint) {
      const int member = one.second;
      std::vector<Group> changed = groups_;
      const auto dropped = std::find_if(changed.begin(), changed.end(),
                                        [&](const Group& g) { return g.members.front() == member; });
      const double omega = dropped->omega;
      changed.erase(dropped);
      if (is_allowed(changed, omega)) groups_ = std::move(changed);
    }
  }

  const ModalModel& model_;
  double allowed_db_;
  AudibleModes audible_;
  std::vector<Band> bands_;  // of all modes
  std::vector<Group> groups_;
};

ModalModel apply_groups(const ModalModel& model, const ModeMerger& merging) {
  ModalModel out = model;
  const std::size_t count = merging.groups().size(), modes = std::size_t(model.modes());
  out.angular_frequency.clear();
  out.damping.clear();
  out.radiation.clear();
  out.shapes.assign(3 * model.points.size() * count, 0.0f);
  for (std::size_t g = 0; g < count; ++g) {
    const Group& group = merging.groups()[g];
    if (group.members.size() == 1) {
      const auto m = std::size_t(group.members.front());
      out.angular_frequency.push_back(model.angular_frequency[m]);
      out.damping.push_back(model.damping[m]);
      out.radiation.push_back(model.radiation[m]);
    } else {
      out.angular_frequency.push_back(group.omega);
      out.damping.push_back(merging.damping(group.omega));
      // Modes of equal frequency stay mass-normalised this way: the merged shape is one axis of a rotated
      // basis.
      double power = 0;
      for (const int m : group.members) power += std::pow(model.radiation[std::size_t(m)], 2);
      out.radiation.push_back(std::sqrt(power));
    }
    for (const int m : group.members) {
      const double radiation = out.radiation[g];
      const auto weight = float(radiation != 0 ? model.radiation[std::size_t(m)] / radiation : 1);
      for (std::size_t row = 0; row < 3 * model.points.size(); ++row)
        out.shapes[row * count + g] += weight * model.shapes[row * modes + std::size_t(m)];
    }
  }
  return out;
}

}  // namespace

void merge_modes(ModalModel& model, double allowed_db) {
  if (!(allowed_db > 0) || model.modes() < 2) return;
  const std::vector<Band> before = audible_bands(audible_modes(model));
  // The search uses a subset of points; if the error over all points is too large, retry with a tighter
  // limit.
  for (double tried_db = allowed_db; tried_db > 0.01 * allowed_db; tried_db *= 0.7) {
    ModeMerger merging(model, tried_db);
    merging.run();
    ModalModel merged = apply_groups(model, merging);
    quantise_shapes(merged);
    const SpectralError error = spectral_error(before, audible_modes(merged));
    if (safety_factor * error.max_db > allowed_db) continue;
    merged.modes_before_merging = model.modes();
    merged.merge_error_db = safety_factor * error.max_db;
    merged.merge_error_rms_db = safety_factor * error.rms_db;
    model = std::move(merged);
    return;
  }
}

namespace {

constexpr double min_response = 1e-5;    // of a filter: less is not in the band
constexpr double max_distance_erb = 10;  // bandwidths: resonances beyond are not in the band either
constexpr double min_band_share = 1e-6;  // of the strongest band's mean energy: less is inaudible

// The filter's power response that many bandwidths from its centre.
double rounded_exponential(double bandwidths) {
  return (1 + 4 * bandwidths) * std::exp(-4 * bandwidths);
}

constexpr std::array breakpoints{0.0, 0.05, 0.1,  0.15, 0.2, 0.3, 0.4, 0.5, 0.65,
                                 0.8, 1.0,  1.25, 1.5,  2.0, 2.5, 3.0, 4.0};

// The integral over all w of the filter's response times a resonance 1 / (d + i (w - omega)), over pi. Exact
// for a piecewise-linear response, which is never negative, so no energy can be negative.
//
// On one piece, with x = w - omega, the response is r0 + s (x - x0). Put z = d + i x: x = i (d - z), dx = -i
// dz, and
//   (r0 + s (x - x0)) / z = (r0 - s x0 + i s d) / z - i s,
// whose integral from x0 to x1 is -i (r0 - s x0 + i s d) (log z1 - log z0) - i s (x1 - x0).
std::complex<double> filtered_resonance(double omega, double d, double centre) {
  static const auto responses = [] {
    std::array<double, breakpoints.size()> all{};
    std::transform(breakpoints.begin(), breakpoints.end(), all.begin(), rounded_exponential);
    return all;
  }();
  const double width = 2 * std::numbers::pi * erb(centre);
  const std::complex<double> i(0, 1);
  std::complex<double> sum = 0;
  for (const double side : {-1.0, 1.0}) {
    const double middle = 2 * std::numbers::pi * centre - omega;
    std::complex<double> log_from = std::log(std::complex(d, middle));
    for (std::size_t k = 0; k + 1 < breakpoints.size(); ++k) {
      const double from = middle + side * breakpoints[k] * width,
                   along = side * (breakpoints[k + 1] - breakpoints[k]) * width;
      const double slope = (responses[k + 1] - responses[k]) / along;
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

AudibleModes audible_modes(const ModalModel& model, int stride) {
  AudibleModes audible;
  const Index modes = model.modes(), points = (Index(model.points.size()) + stride - 1) / stride;
  audible.angular_frequency = Eigen::Map<const Eigen::VectorXd>(model.angular_frequency.data(), modes);
  audible.damping = Eigen::Map<const Eigen::VectorXd>(model.damping.data(), modes);
  audible.gain.resize(3 * points, modes);
  for (Index p = 0; p < points; ++p) {
    for (Index m = 0; m < modes; ++m)
      audible.gain.block<3, 1>(3 * p, m) =
          model.radiation[std::size_t(m)] * model.shape(int(p) * stride, int(m));
  }
  return audible;
}

std::vector<double> band_centres(const AudibleModes& modes) {
  std::vector<double> centres;
  if (modes.modes() == 0) return centres;
  const double first = erb_number(modes.angular_frequency.minCoeff() / (2 * std::numbers::pi));
  const double last = erb_number(modes.angular_frequency.maxCoeff() / (2 * std::numbers::pi));
  for (double number = std::round(first); number <= std::round(last); ++number)
    centres.push_back(hertz_at_erb(number));
  return centres;
}

std::vector<Mat3> band_energy(const AudibleModes& modes, double centre) {
  std::vector<Index> in_band;
  std::vector<std::complex<double>> resonance;
  for (Index m = 0; m < modes.modes(); ++m) {
    if (std::abs(modes.angular_frequency[m] / (2 * std::numbers::pi) - centre) >
        max_distance_erb * erb(centre))
      continue;
    const auto h = filtered_resonance(modes.angular_frequency[m], modes.damping[m], centre);
    if (std::abs(h) < min_response) continue;
    in_band.push_back(m);
    resonance.push_back(h);
  }
  const Index count = Index(in_band.size());
  MatrixXd pairs(count, count), gain(modes.gain.rows(), count);
  for (Index i = 0; i < count; ++i) {
    const Index a = in_band[std::size_t(i)];
    gain.col(i) = modes.gain.col(a);
    for (Index k = 0; k < count; ++k) {
      // 1 / (z_a z_b*) = (1 / z_a + 1 / z_b*) / (z_a + z_b*).
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

std::vector<Band> audible_bands(const AudibleModes& modes) {
  std::vector<Band> bands;
  double strongest = 0;
  for (const double centre : band_centres(modes)) {
    bands.push_back({centre, band_energy(modes, centre), Mat3::Zero()});
    Band& band = bands.back();
    for (const Mat3& q : band.energy) band.mean += q / double(band.energy.size());
    strongest = std::max(strongest, band.mean.trace());
  }
  std::erase_if(bands, [&](const Band& b) { return !(b.mean.trace() > min_band_share * strongest); });
  return bands;
}

SpectralError spectral_error(std::span<const Band> before, const AudibleModes& after) {
  SpectralError error;
  double squares = 0;
  std::size_t count = 0;
  for (const Band& band : before) {
    const std::vector<Mat3> energy = band_energy(after, band.centre);
    // The second term regularises directions in which the band has no energy.
    const Mat3 floor = node_floor * band.mean + 1e-9 * band.mean.trace() * Mat3::Identity();
    for (std::size_t p = 0; p < energy.size(); ++p) {
      const Mat3 old_energy = band.energy[p] + floor, new_energy = energy[p] + floor;
      error.max_db = std::max(error.max_db, worst_direction(new_energy, old_energy));
      squares += std::pow(decibels(new_energy.trace() / old_energy.trace()), 2);
      ++count;
    }
  }
  if (count > 0) error.rms_db = std::sqrt(squares / double(count));
  return error;
}

}  // namespace intaglio::sound
