#include "sound/rubbing.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/fourier.h"
#include "core/portable_math.h"

namespace intaglio::sound {

namespace {

struct TablePoint {
  std::size_t index;
  double fraction;
};

TablePoint table_point(double distance, double spacing) {
  const double point = distance / spacing;
  const double below = std::floor(point);
  const double periods = std::floor(below / MicroNoise::table_size);
  return {std::size_t(below - periods * MicroNoise::table_size), point - below};
}

// One axis of the traversal: which texel, and at which fraction of the path the next one begins.
struct AxisWalk {
  int texel;
  int step;
  double next;     // fraction of the path at the next border
  double between;  // fraction of the path from one border to the next

  AxisWalk(double from, double to) : texel(int(std::floor(from))), step(to < from ? -1 : 1) {
    const double length = std::abs(to - from);
    const double border = step > 0 ? texel + 1 - from : from - texel;
    between = length > 0 ? 1 / length : std::numeric_limits<double>::infinity();
    next = length > 0 ? border / length : between;
  }
  void advance() {
    texel += step;
    next += between;
  }
};

constexpr double resting_fade = 0.03;  // s
constexpr double pressed_share = 0.25;

}  // namespace

MicroNoise::MicroNoise(const MicroRoughness& roughness, std::uint64_t seed)
    : spacing_(roughness.correlation_length / points_per_correlation) {
  assert(roughness.correlation_length > 0);
  Random random(seed);
  std::vector<std::complex<double>> spectrum(table_size);
  for (std::size_t k = 1; k < table_size / 2; ++k) {
    const double wavenumber = 2 * std::numbers::pi * double(k) / (table_size * spacing_);
    const double relative = std::max(wavenumber * roughness.correlation_length, 1.0);
    const double magnitude = elementary::pow(relative, 0.5 * roughness.spectral_slope);
    const auto [sine, cosine] = elementary::sin_cos(2 * std::numbers::pi * random.uniform());
    spectrum[k] = {magnitude * cosine, magnitude * sine};
    spectrum[table_size - k] = std::conj(spectrum[k]);
  }
  std::vector<std::complex<double>> noise(table_size);
  Fourier<double>(table_size, true)(noise.data(), spectrum.data());
  double power = 0;
  for (const auto& x : noise) power += x.real() * x.real() / table_size;
  double sum = 0;
  for (const auto& x : noise) table_.push_back(float(x.real() / std::sqrt(power)));
  for (std::size_t k = 0; k < table_size; ++k) {
    integral_.push_back(sum);
    sum += 0.5 * (double(table_[k]) + double(table_[(k + 1) % table_size]));
  }
}

double MicroNoise::sample(double distance) const {
  const auto [index, fraction] = table_point(distance, spacing_);
  const double here = table_[index], next = table_[(index + 1) % table_size];
  return here + fraction * (next - here);
}

// The mean of a period is zero except for rounding, so whole periods add nothing.
double MicroNoise::integral(double distance) const {
  const auto [index, fraction] = table_point(distance, spacing_);
  const double here = table_[index], next = table_[(index + 1) % table_size];
  return integral_[index] + fraction * (here + 0.5 * fraction * (next - here));
}

double MicroNoise::mean(double from, double to) const {
  const double points = (to - from) / spacing_;
  // Over a hundredth of a table spacing the noise is linear, and the difference of integrals mostly rounding.
  if (std::abs(points) < 0.01) return sample(0.5 * (from + to));
  return (integral(to) - integral(from)) / points;
}

double micro_level(const MicroRoughness& roughness, double level) {
  return level * roughness.rms_height / roughness.correlation_length;
}

Vec3 normal_momentum(double mass, const Vec3& v_t, const Vec3& n_g, const Vec3& n_s) {
  return mass * (-v_t.dot(n_s) / std::max(n_g.dot(n_s), min_normal_cosine)) * n_g;
}

MesoWalk walk_texels(const surface::Surface& surface, const Vec2& uv0, const Vec2& uv1, double mass,
                     const Vec2& sweep, std::span<MesoImpulse> out) {
  const double width = surface.width(), height = surface.height();
  const Vec3 v_t(sweep.x(), sweep.y(), 0);
  AxisWalk u(uv0.x() * width, uv1.x() * width);
  AxisWalk v(uv0.y() * height, uv1.y() * height);
  const auto momentum_here = [&] {
    const Vec3 n_s = surface.texel_normal({(u.texel + 0.5) / width, (v.texel + 0.5) / height});
    return normal_momentum(mass, v_t, Vec3::UnitZ(), n_s).z();
  };
  MesoWalk walk;
  double momentum = momentum_here();
  while (std::min(u.next, v.next) < 1) {
    if (walk.count == out.size()) {
      walk.is_complete = false;
      break;
    }
    AxisWalk& axis = u.next < v.next ? u : v;
    const double fraction = axis.next;
    axis.advance();
    const double after = momentum_here();
    out[walk.count++] = {fraction, after - momentum};
    momentum = after;
  }
  return walk;
}

ContactMotion contact_motion(const Vec3& v_t, const Vec3& spin) {
  ContactMotion motion;
  // The contact moves with the body's centre; the body's surface there moves at v_t + spin.
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

void Rubbing::begin(double start, double end, ContactMotion to) {
  to.force = 0;
  to_ = to;
  step(start, end, to, {false, false});
}

ContactMotion Rubbing::interpolate(double t) const {
  const auto between = [t](const auto& a, const auto& b) { return a + t * (b - a); };
  ContactMotion now;
  now.force = between(from_.force, to_.force);
  now.slip = between(from_.slip, to_.slip);
  for (std::size_t k = 0; k < 2; ++k) {
    now.sweep[k] = between(from_.sweep[k], to_.sweep[k]);
    const ReliefPoint &from = from_.relief[k], &to = to_.relief[k];
    now.relief[k] = {to.surface, between(from.uv, to.uv), between(from.sweep, to.sweep)};
  }
  return now;
}

// The impulse F dt sum of level_k share_k noise_k(x_k) over both bodies, with F the normal force and x_k the
// distance swept over body k; the noise is averaged over the sample.
double Rubbing::micro(const ContactMotion& now, double fade, double dt) {
  double force = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    RubbingBody& body = bodies_[k];
    const double swept = now.sweep[k] * fade * dt;
    if (swept == 0 || body.level == 0) continue;
    force += body.level * scraped_share(now.sweep[k], now.slip) *
             body.noise->mean(body.distance, body.distance + swept);
    body.distance += swept;
  }
  return now.force * fade * force * dt;
}

// Eq. 1.4 continuous in time: -v_t . n_s / n_g . n_s is the rate at which the height changes, grad h . sweep,
// so p_n = m grad h . sweep, and a sample's impulse is its change since the last sample. Both contributions
// add, since the gap changes by both. A contact cannot pull: the impulse is at least -F dt.
double Rubbing::meso(const ContactMotion& now, double fade, double dt) {
  double impulse = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const ReliefPoint& point = now.relief[k];
    if (!point.surface) continue;
    const double momentum =
        mass_ * point.surface->smooth(point.uv, footprint_).gradient.dot(point.sweep) * fade;
    impulse += momentum - momentum_[k].value_or(momentum);
    momentum_[k] = momentum;
  }
  return std::max(impulse, -now.force * dt);
}

bool Rubbing::sample(std::int64_t first, double dt, std::span<float> out) {
  if (std::max(from_.force, to_.force) == 0) return false;
  if (from_.sweep == std::array<double, 2>{} && to_.sweep == std::array<double, 2>{}) return false;
  if (double(first) * dt >= end_ + resting_fade) return false;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double time = double(first + std::int64_t(k)) * dt;
    const ContactMotion now = interpolate(std::clamp((time - start_) / (end_ - start_), 0.0, 1.0));
    // After its last step a contact rests (its body sleeps) until a further step or its end is reported: the
    // noise fades out, slowly enough not to click.
    const double rest = std::clamp((time - end_) / resting_fade, 0.0, 1.0);
    if (rest == 1) {
      out[k] = 0;
      continue;
    }
    const double fade = 0.5 + 0.5 * elementary::cos(std::numbers::pi * rest);
    out[k] = float(micro(now, fade, dt) + meso(now, fade, dt));
  }
  return true;
}

}  // namespace intaglio::sound
