#include "intaglio/haptics/proxy.h"

#include <algorithm>
#include <cmath>

namespace intaglio::haptics {

namespace {

constexpr double converged = 1e-7;  // m: a tenth of a millinewton
constexpr int most_steps = 3;

}  // namespace

void Proxy::start(const Solid& solid, const Vec3& x) {
  y_ = x;
  at_ = solid.at(y_);
  for (int k = 0; k < 4 && at_.depth > 0; ++k) {
    y_ -= (1 + 1e-9) * at_.depth / at_.gradient.squaredNorm() * at_.gradient;
    at_ = solid.at(y_);
  }
  started_ = true;
}

double Proxy::energy(const Vec3& x, const ContactStiffness& k, const Vec3& y, double depth) const {
  const double inside = std::max(depth, 0.0);
  return 0.5 * (k.coupling * (x - y).squaredNorm() + k.surface * inside * inside);
}

Vec3 Proxy::step(const Vec3& x, const ContactStiffness& k, double friction) const {
  const Vec3& g = at_.gradient;
  const double g2 = g.squaredNorm();
  // Depth at the tip if the surface went on as it is at the proxy.
  const double depth = at_.depth + g.dot(x - y_);
  if (depth <= 0) return x - y_;
  // The minimum of W with the depth linearised, and the normal force there.
  const double along = k.surface * depth / (k.coupling + k.surface * g2);
  const Vec3 to_minimum = x - along * g - y_;
  if (friction == 0) return to_minimum;
  const double load = k.coupling * along;  // the normal force's part along the base's normal
  const Vec3 normal_part = to_minimum.dot(g) / g2 * g;
  const Vec3 tangential = to_minimum - normal_part;
  const double pull = k.coupling * tangential.norm();
  if (pull <= friction * load) return normal_part;
  return normal_part + (1 - friction * load / pull) * tangential;
}

// Goes along `step`, or less far, where W does not grow; false: nowhere.
bool Proxy::descend(const Solid& solid, const Vec3& x, const ContactStiffness& k, const Vec3& step,
                    int& samples) {
  const double before = energy(x, k, y_, at_.depth);
  const auto slope = [&](const Vec3& y, const Penetration& at) {
    return (k.coupling * (y - x) + k.surface * std::max(at.depth, 0.0) * at.gradient).dot(step);
  };
  const double slope_here = slope(y_, at_);
  double length = 1;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const Vec3 y = y_ + length * step;
    const Penetration at = solid.at(y);
    ++samples;
    if (energy(x, k, y, at.depth) <= before) {
      y_ = y;
      at_ = at;
      return true;
    }
    // The valley's bottom by the secant of both slopes.
    const double slope_there = slope(y, at);
    const double secant = slope_here < 0 && slope_there > 0 ? -slope_here / (slope_there - slope_here) : 0.5;
    length *= std::clamp(secant, 0.05, 0.9);
  }
  return false;
}

Proxy::Contact Proxy::move(const Solid& solid, const Vec3& x, const ContactStiffness& k, double friction) {
  Contact contact;
  if (!started_) {
    start(solid, x);
    contact.samples = 1;
  }
  for (int n = 0; n < most_steps; ++n) {
    const Vec3 wanted = step(x, k, friction);
    if (wanted.squaredNorm() < converged * converged) break;
    if (!descend(solid, x, k, wanted, contact.samples)) break;
  }
  contact.force = k.coupling * (y_ - x);
  contact.energy = energy(x, k, y_, at_.depth);
  contact.touching = contact.energy > 1e-12;  // below, the spring is what convergence left over
  contact.normal = -at_.gradient.normalized();
  return contact;
}

}  // namespace intaglio::haptics
