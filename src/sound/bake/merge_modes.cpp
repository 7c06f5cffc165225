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

constexpr double slowest_beat = 0.5;  // of the sum of both decays: the distance of angular frequencies
constexpr double least_pitch = 0.002;
constexpr double masked = 0.01;  // of its band's energy
constexpr int tried_points = 100;
constexpr double reach = 4;  // bands from a mode that it is heard in
// Of rendered audio, which changes by up to 1 % more than the formula says (tests/sound/test_merge_modes.cpp,
// "errs by more than is stated"); stated is five times that.
constexpr double formula_error = 1.05;

// Modes that will be one.
struct Group {
  std::vector<int> members;  // by frequency
  double omega = 0;
  double weight = 0;  // radiated energy over the surface, of all together where they are of one frequency
};

class Merging {
 public:
  Merging(const ModalModel& model, double allowed_db)
      : model_(model),
        allowed_db_(allowed_db),
        heard_(heard_modes(model, 1 + int(model.points.size()) / tried_points)),
        bands_(bands_of(heard_)) {
    for (int m = 0; m < model.modes(); ++m)
      groups_.push_back({{m},
                         heard_.angular_frequency[m],
                         heard_.gain.col(m).squaredNorm() / std::max(1e-12, heard_.damping[m])});
  }

  void run() {
    merge_close();
    drop_masked();
  }
  const std::vector<Group>& groups() const { return groups_; }

  double damping(double omega) const {
    return 0.5 * (model_.material.rayleigh_alpha + model_.material.rayleigh_beta * omega * omega);
  }

  // The modes of some groups.
  HeardModes heard(std::span<const Group> groups) const {
    HeardModes modes{Eigen::VectorXd(Index(groups.size())), Eigen::VectorXd(Index(groups.size())),
                     Eigen::MatrixXd::Zero(heard_.gain.rows(), Index(groups.size()))};
    for (std::size_t g = 0; g < groups.size(); ++g) {
      modes.angular_frequency[Index(g)] = groups[g].omega;
      modes.damping[Index(g)] = damping(groups[g].omega);
      for (const int m : groups[g].members) modes.gain.col(Index(g)) += heard_.gain.col(m);
    }
    return modes;
  }

 private:
  Group together(const Group& a, const Group& b) const {
    Group both{a.members, 0, a.weight + b.weight};
    both.members.insert(both.members.end(), b.members.begin(), b.members.end());
    std::sort(both.members.begin(), both.members.end());
    const double share = both.weight > 0 ? b.weight / both.weight : 0.5;
    both.omega = a.omega + share * (b.omega - a.omega);
    // Energies of modes of one frequency depend on their basis; that of their sum does not.
    if (a.omega == b.omega) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(heard_.gain.rows());
      for (const int m : both.members) sum += heard_.gain.col(m);
      both.weight = sum.squaredNorm() / std::max(1e-12, damping(both.omega));
    }
    return both;
  }

  // How fast the two beat for their decays; more than 1 where it would be heard.
  double distance(const Group& a, const Group& b) const {
    const Group both = together(a, b);
    double most = 0;
    for (const int m : both.members) {
      const double omega = model_.angular_frequency[std::size_t(m)], apart = std::abs(omega - both.omega);
      most = std::max(most, apart / (least_pitch * omega));
    }
    const double span = model_.angular_frequency[std::size_t(both.members.back())] -
                        model_.angular_frequency[std::size_t(both.members.front())];
    return std::max(most, span / (slowest_beat * 2 * damping(both.omega)));
  }

  // Whether the sound of the bands near `omega` stays within what is allowed when groups_ are `changed`.
  bool is_allowed(const std::vector<Group>& changed, double omega) const {
    const double place = erb_number(omega / (2 * std::numbers::pi));
    const auto first = std::find_if(bands_.begin(), bands_.end(),
                                    [&](const Band& b) { return erb_number(b.centre) > place - reach; });
    const auto end = std::find_if(first, bands_.end(),
                                  [&](const Band& b) { return erb_number(b.centre) >= place + reach; });
    return spectral_error({first, end}, heard(changed)).max_db <= allowed_db_;
  }

  void merge_close() {
    std::vector<bool> refused(groups_.size(), false);  // of each group and the one above it
    for (;;) {
      std::size_t best = groups_.size();
      double least = 1;
      for (std::size_t g = 0; g + 1 < groups_.size(); ++g) {
        if (refused[g]) continue;
        const double d = distance(groups_[g], groups_[g + 1]);
        if (d < least) {
          least = d;
          best = g;
        }
      }
      if (best == groups_.size()) return;
      std::vector<Group> changed = groups_;
      changed[best] = together(groups_[best], groups_[best + 1]);
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

  // The most that a mode has of its band's energy, anywhere.
  double share(const HeardModes& modes, Index m) const {
    const double centre = modes.angular_frequency[m] / (2 * std::numbers::pi);
    const std::vector<Mat3> all = band_energy(modes, centre);
    double mean = 0, most = 0;
    for (const Mat3& q : all) mean += q.trace() / double(all.size());
    for (Index p = 0; p < modes.points(); ++p) {
      const double own = modes.gain.block<3, 1>(3 * p, m).squaredNorm() / (4 * modes.damping[m]);
      most = std::max(most, own / (all[std::size_t(p)].trace() + node_share * mean));
    }
    return most;
  }

  void drop_masked() {
    const HeardModes modes = heard(groups_);
    std::vector<std::pair<double, int>> faint;  // share, first member
    for (Index g = 0; g < modes.modes(); ++g) {
      const double s = share(modes, g);
      if (s < masked) faint.emplace_back(s, groups_[std::size_t(g)].members.front());
    }
    std::sort(faint.begin(), faint.end());
    for (const auto& one : faint) {
      const int member = one.second;
      std::vector<Group> changed = groups_;
      const auto gone = std::find_if(changed.begin(), changed.end(),
                                     [&](const Group& g) { return g.members.front() == member; });
      const double omega = gone->omega;
      changed.erase(gone);
      if (is_allowed(changed, omega)) groups_ = std::move(changed);
    }
  }

  const ModalModel& model_;
  double allowed_db_;
  HeardModes heard_;
  std::vector<Band> bands_;  // of all modes
  std::vector<Group> groups_;
};

ModalModel with_groups(const ModalModel& model, const Merging& merging) {
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
  const std::vector<Band> before = bands_of(heard_modes(model));
  // Tried at some points, stated for all of them: what they reveal asks for less.
  for (double tried_db = allowed_db; tried_db > 0.01 * allowed_db; tried_db *= 0.7) {
    Merging merging(model, tried_db);
    merging.run();
    ModalModel merged = with_groups(model, merging);
    round_shapes(merged);
    const SpectralError error = spectral_error(before, heard_modes(merged));
    if (formula_error * error.max_db > allowed_db) continue;
    merged.modes_found = model.modes();
    merged.merge_error_db = formula_error * error.max_db;
    merged.merge_error_rms_db = formula_error * error.rms_db;
    model = std::move(merged);
    return;
  }
}

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
