#include "intaglio/sound/merge_modes.h"

#include <algorithm>
#include <cmath>
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

}  // namespace intaglio::sound
