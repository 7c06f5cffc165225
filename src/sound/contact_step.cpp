#include "sound/contact_step.h"

#include <algorithm>
#include <cmath>

namespace intaglio::sound {

namespace {

constexpr double share_of_new = 1.0 / 3;

}  // namespace

void ContactStep::add(const ContactEvent& event) {
  if (event.phase == ContactPhase::end) return;
  has_begin |= event.phase == ContactPhase::begin;
  impulse += event.impulse;
  normal_impulse += event.impulse.dot(event.n_g);
  if (count < max_points) points[count++] = event;
}

double ContactStep::share(std::size_t i) const {
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) sum += points[k].impulse.norm();
  return sum > 0 ? points[i].impulse.norm() / sum : 1 / static_cast<double>(count);
}

const ContactEvent& ContactStep::main_point() const {
  const auto less = [](const ContactEvent& a, const ContactEvent& b) {
    return a.impulse.norm() < b.impulse.norm();
  };
  return *std::max_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), less);
}

std::optional<double> ContactStep::touch() const {
  std::optional<double> when;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(points[i].touch_age) || share(i) < share_of_new) continue;
    const double after = std::clamp(1 - points[i].touch_age / duration, 0.0, 1.0);
    when = std::min(when.value_or(1), after);
  }
  return when;
}

const ContactEvent& ContactStep::nearest_point(const Vec3& place) const {
  const auto less = [&](const ContactEvent& a, const ContactEvent& b) {
    return (a.point - place).squaredNorm() < (b.point - place).squaredNorm();
  };
  return *std::min_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), less);
}

Vec3 ContactForce::step(const Vec3& impulse) {
  const double before = previous_.squaredNorm();
  const double common = before > 0 ? std::clamp(impulse.dot(previous_) / before, 0.0, 1.0) : 0.0;
  const Vec3 lasting = common * previous_;
  Vec3 blow = impulse - lasting;
  const double lasted = lasting_.norm();
  if (lasting.norm() < lasted) blow -= (1 - lasting.norm() / lasted) * lasting_;
  if (blow.norm() <= dead_band_ * std::max(lasting.norm(), lasted)) blow.setZero();
  previous_ = impulse;
  lasting_ = lasting;
  return blow;
}

}  // namespace intaglio::sound
