#include "intaglio/sound/contact_step.h"

#include <algorithm>

namespace intaglio::sound {

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

const ContactEvent& ContactStep::nearest_point(const Vec2& uv) const {
  const auto less = [&](const ContactEvent& a, const ContactEvent& b) {
    return (a.uv - uv).norm() < (b.uv - uv).norm();
  };
  return *std::min_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), less);
}

}  // namespace intaglio::sound
