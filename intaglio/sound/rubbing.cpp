#include "intaglio/sound/rubbing.h"

#include <algorithm>
#include <numbers>

#include "intaglio/core/elementary.h"

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

void Rubbing::step(double start, double end, const ContactMotion& to,
                   const std::array<bool, 2>& follows_path) {
  start_ = start;
  end_ = end;
  from_ = to_;
  to_ = to;
  for (std::size_t k = 0; k < 2; ++k) {
    if (follows_path[k]) continue;
    from_.relief[k] = to.relief[k];
    momentum_[k].reset();
  }
}

void Rubbing::touch(double start, double end, ContactMotion to) {
  to.force = 0;
  to_ = to;
  step(start, end, to, {false, false});
}

ContactMotion Rubbing::at(double t) const {
  const auto between = [t](const auto& a, const auto& b) { return a + t * (b - a); };
  ContactMotion now;
  now.force = between(from_.force, to_.force);
  now.slip = between(from_.slip, to_.slip);
  for (std::size_t k = 0; k < 2; ++k) {
    now.sweep[k] = between(from_.sweep[k], to_.sweep[k]);
    const ReliefPlace &from = from_.relief[k], &to = to_.relief[k];
    now.relief[k] = {to.surface, between(from.uv, to.uv), between(from.sweep, to.sweep)};
  }
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

// p_n of the slope under the patch: -v_t . n_s / n_g . n_s is the rate at which the height changes. What both
// reliefs do adds up: it is their gap that changes.
double Rubbing::meso(const ContactMotion& now, double fade, double dt) {
  double impulse = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const ReliefPlace& place = now.relief[k];
    if (!place.surface) continue;
    const double momentum =
        mass_ * place.surface->smooth(place.uv, footprint_).gradient.dot(place.sweep) * fade;
    impulse += momentum - momentum_[k].value_or(momentum);
    momentum_[k] = momentum;
  }
  return std::max(impulse, -now.force * dt);
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
    const double fade = 0.5 + 0.5 * elementary::cos(std::numbers::pi * rest);
    out[k] = static_cast<float>(micro(now, fade, dt) + meso(now, fade, dt));
  }
  return true;
}

}  // namespace intaglio::sound
