#include "evaluate/truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/body_truth.h"
#include "evaluate/loudness.h"
#include "evaluate/reference_motion.h"
#include "evaluate/spectrum_distance.h"
#include "evaluate/vibration.h"

namespace intaglio::evaluate {

namespace {

constexpr double degrees = 180 / std::numbers::pi;

double angle(const Vec3& a, const Vec3& b) {
  return elementary::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * degrees;
}

// Root mean square of what a mean over 10 ms leaves.
double fast_part(const std::vector<double>& series, double rate) {
  const auto half = std::int64_t(std::lround(0.005 * rate));
  const auto n = std::int64_t(series.size());
  std::vector<double> sum(series.size() + 1, 0.0);
  for (std::size_t k = 0; k < series.size(); ++k) sum[k + 1] = sum[k] + series[k];
  double squares = 0;
  for (std::int64_t k = half; k + half < n; ++k) {
    const double around =
        (sum[std::size_t(k + half + 1)] - sum[std::size_t(k - half)]) / double(2 * half + 1);
    squares += (series[std::size_t(k)] - around) * (series[std::size_t(k)] - around);
  }
  return n > 2 * half ? std::sqrt(squares / double(n - 2 * half)) : 0;
}

}  // namespace

TouchError touch_error(const Crossing& crossing, const Crossing& reference) {
  TouchError out;
  std::vector<double> felt, wanted;
  double squares = 0, angles = 0;
  std::size_t both = 0;
  for (std::size_t k = 0; k < crossing.force.size(); ++k) {
    const double at = (crossing.time(k) - reference.start) * reference.rate;
    if (at < 0 || at >= double(reference.force.size())) continue;
    const Vec3 &force = crossing.force[k], &truth = reference.force[std::size_t(at)];
    squares += (force - truth).squaredNorm();
    felt.push_back(force.norm());
    wanted.push_back(truth.norm());
    if (force.norm() > 0.02 && truth.norm() > 0.02) {
      angles += angle(force, truth);
      ++both;
    }
  }
  if (felt.empty()) return out;
  out.force_n = std::sqrt(squares / double(felt.size()));
  out.direction = both > 0 ? angles / double(both) : std::numeric_limits<double>::quiet_NaN();
  out.buzz_n = std::max(0.0, fast_part(felt, crossing.rate) - fast_part(wanted, crossing.rate));
  out.bands_db =
      band_distance(vibration_energy(felt, crossing.rate), vibration_energy(wanted, crossing.rate));
  const auto intensity = [&](const std::vector<double>& force) {
    return vibration_intensity(displacement_of_force(force), crossing.rate);
  };
  const VibrationIntensity strong = intensity(felt), true_strong = intensity(wanted);
  out.intensity_steps = intensity_steps(strong.felt(), true_strong.felt());
  out.pacinian_steps = intensity_steps(strong.pacinian, true_strong.pacinian);
  out.non_pacinian_steps = intensity_steps(strong.non_pacinian, true_strong.non_pacinian);
  return out;
}

MotionError motion_error(const Crossing& crossing) {
  MotionError out;
  for (const Vec3& off : crossing.strayed) {
    out.place_mm += off.head<2>().squaredNorm();
    out.height_mm += off.z() * off.z();
  }
  const auto n = double(crossing.strayed.size());
  out.place_mm = 1000 * std::sqrt(out.place_mm / n);
  out.height_mm = 1000 * std::sqrt(out.height_mm / n);
  return out;
}

double normal_error(const Subject& subject, const Candidate& candidate, const ReferenceRoll& reference) {
  const double radius = subject.ball_radius();
  const ReferenceBall truth(subject.reference(), radius, subject.scene(candidate).balls[0].material,
                            subject.surface(candidate).material);
  std::vector<Pose> poses;
  std::vector<std::vector<Vec3>> normals;
  const auto every = std::size_t(0.05 * reference_rate);
  for (std::size_t k = every; k < reference.states.size(); k += every) {
    if (!reference.crossing.touching[k - 1]) continue;
    const Vec3& centre = reference.states[k].pose.position;
    poses.push_back({centre, Quat::Identity()});
    normals.push_back(truth.normals_at(centre));
  }
  return contact_normal_error(subject, candidate, contact::Sphere{radius}, poses, normals);
}

SoundError sound_error(const Crossing& crossing, const Crossing& reference) {
  const auto loudness = [](const Crossing& of) { return loudness_over_time(of.sound, of.sample_rate); };
  const double rate = crossing.sample_rate;
  return {log_spectral_distance(crossing.sound, reference.sound, rate, {.ignore_gain = true}),
          loudness_distance(loudness(crossing), loudness(reference)),
          match_onsets(crossing.sound, reference.sound, rate),
          interval_distance(impulses(crossing.sound, rate), impulses(reference.sound, rate)),
          crossing.probe == Probe::ball && reference.is_strike
              ? decay_difference(decay_times(crossing.sound, rate), decay_times(reference.sound, rate))
              : std::numeric_limits<double>::quiet_NaN()};
}

}  // namespace intaglio::evaluate
