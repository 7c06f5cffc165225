#include "intaglio/sound/rubbing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace intaglio::sound {

namespace {

constexpr double resting_fade = 0.03;  // s
constexpr double pressed_share = 0.25;

}  // namespace

ContactMotion contact_motion(const Vec3& v_t, const Vec3& spin) {
  ContactMotion motion;
  // The contact goes along with the body's centre; the body's surface there moves at v_t + spin.
  motion.sweep = {spin.norm(), v_t.norm()};
  motion.slip = (v_t + spin).norm();
  return motion;
}

double scraped_share(double sweep, double slip) {
  if (!(sweep > 0)) return 0;
  return pressed_share + (1 - pressed_share) * std::min(1.0, slip / sweep);
}

void Rubbing::meet(const std::array<RubbingBody, 2>& bodies, const surface::Surface* relief, double mass) {
  *this = Rubbing(bodies, relief, mass);
}

void Rubbing::step(double start, double end, const ContactMotion& to, bool follows_path) {
  start_ = start;
  end_ = end;
  from_ = to_;
  to_ = to;
  if (follows_path) return;
  from_.uv = to.uv;
  from_.velocity = to.velocity;
  has_momentum_ = false;
}

void Rubbing::touch(double start, double end, ContactMotion to) {
  to.force = 0;
  to_ = to;
  step(start, end, to, false);
}

ContactMotion Rubbing::at(double t) const {
  const auto between = [t](const auto& a, const auto& b) { return a + t * (b - a); };
  ContactMotion now;
  now.force = between(from_.force, to_.force);
  for (std::size_t k = 0; k < 2; ++k) now.sweep[k] = between(from_.sweep[k], to_.sweep[k]);
  now.slip = between(from_.slip, to_.slip);
  now.uv = between(from_.uv, to_.uv);
  now.velocity = between(from_.velocity, to_.velocity);
  return now;
}

double Rubbing::micro(const ContactMotion& now, double fade, double dt) {
  double force = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    RubbingBody& body = bodies_[k];
    const double way = now.sweep[k] * fade * dt;
    if (way == 0 || body.level == 0) continue;
    force += body.level * scraped_share(now.sweep[k], now.slip) *
             body.noise->mean(body.distance, body.distance + way);
    body.distance += way;
  }
  return now.force * fade * force * dt;
}

// p_n of the slope under the patch: -v_t . n_s / n_g . n_s is the rate at which the height changes.
double Rubbing::meso(const ContactMotion& now, double fade, double dt) {
  if (!relief_) return 0;
  const double climb = relief_->smooth(now.uv, footprint_).gradient.dot(now.velocity) * fade;
  const double before = has_momentum_ ? momentum_ : mass_ * climb;
  has_momentum_ = true;
  momentum_ = mass_ * climb;
  return std::max(momentum_ - before, -now.force * dt);
}

bool Rubbing::sample(std::int64_t first, double dt, std::span<float> out) {
  if (std::max(from_.force, to_.force) == 0) return false;
  if (from_.sweep == std::array<double, 2>{} && to_.sweep == std::array<double, 2>{}) return false;
  if (static_cast<double>(first) * dt >= end_ + resting_fade) return false;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double time = static_cast<double>(first + static_cast<std::int64_t>(k)) * dt;
    const ContactMotion now = at(std::clamp((time - start_) / (end_ - start_), 0.0, 1.0));
    // Past its last step a contact rests (its body sleeps) until a further step or its end is reported: the
    // noise dies away, slowly enough not to click.
    const double rest = std::clamp((time - end_) / resting_fade, 0.0, 1.0);
    if (rest == 1) {
      out[k] = 0;
      continue;
    }
    const double fade = 0.5 + 0.5 * std::cos(std::numbers::pi * rest);
    out[k] = static_cast<float>(micro(now, fade, dt) + meso(now, fade, dt));
  }
  return true;
}

}  // namespace intaglio::sound
