#include "sound/contact_step.h"

#include <algorithm>
#include <cmath>

namespace intaglio::sound {

namespace {

constexpr double min_new_share = 1.0 / 3;

}  // namespace

void ContactStep::add(const ContactEvent& event) {
  if (event.phase == ContactPhase::end) return;
  has_begin |= event.phase == ContactPhase::begin;
  impulse += event.impulse;
  normal_impulse += event.impulse.dot(event.n_g);
  if (count < max_points) points[count++] = event;
}

double ContactStep::impulse_share(std::size_t i) const {
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) sum += points[k].impulse.norm();
  return sum > 0 ? points[i].impulse.norm() / sum : 1 / double(count);
}

const ContactEvent& ContactStep::main_point() const {
  const auto less = [](const ContactEvent& a, const ContactEvent& b) {
    return a.impulse.norm() < b.impulse.norm();
  };
  return *std::max_element(points.begin(), points.begin() + std::ptrdiff_t(count), less);
}

std::optional<double> ContactStep::first_touch() const {
  std::optional<double> when;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(points[i].touch_age) || impulse_share(i) < min_new_share) continue;
    const double after = std::clamp(1 - points[i].touch_age / duration, 0.0, 1.0);
    when = std::min(when.value_or(1), after);
  }
  return when;
}

const ContactEvent& ContactStep::nearest_point(const Vec3& place) const {
  const auto less = [&](const ContactEvent& a, const ContactEvent& b) {
    return (a.point - place).squaredNorm() < (b.point - place).squaredNorm();
  };
  return *std::min_element(points.begin(), points.begin() + std::ptrdiff_t(count), less);
}

Vec3 ImpulseSplitter::split(const Vec3& impulse) {
  const double before = previous_.squaredNorm();
  const double common = before > 0 ? std::clamp(impulse.dot(previous_) / before, 0.0, 1.0) : 0.0;
  const Vec3 sustained = common * previous_;
  Vec3 onset = impulse - sustained;
  const double last = sustained_.norm();
  if (sustained.norm() < last) onset -= (1 - sustained.norm() / last) * sustained_;
  if (onset.norm() <= dead_band_ * std::max(sustained.norm(), last)) onset.setZero();
  previous_ = impulse;
  sustained_ = sustained;
  return onset;
}

}  // namespace intaglio::sound
