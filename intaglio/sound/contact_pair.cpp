#include "intaglio/sound/contact_pair.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "intaglio/sound/meso.h"

namespace intaglio::sound {

namespace {

constexpr std::size_t max_crossings = 256;
constexpr double radius_of_flat_pair = 0.01;  // m: where two flat bodies meet, an edge does
constexpr double resting_fade = 0.03;         // s
constexpr double longest_path = 0.25;         // of the texture, in one step; more is a jump

double inverse_mass(const SoundBody& body) {
  return body.is_fixed ? 0 : 1 / body.mass;
}

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

const ContactEvent& ContactStep::nearest_point(const Vec2& uv) const {
  const auto less = [&](const ContactEvent& a, const ContactEvent& b) {
    return (a.uv - uv).norm() < (b.uv - uv).norm();
  };
  return *std::min_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), less);
}

ContactPair::ContactPair(Ensemble& ensemble, const SynthesizerOptions& options)
    : ensemble_(ensemble), options_(options), force_(options.dead_band) {
  for (Side& side : sides_) {
    side.blow_room.resize(static_cast<std::size_t>(ensemble.most_modes()));
    side.normal_room.resize(side.blow_room.size());
  }
}

void ContactPair::meet(int body, int other) {
  const SoundBody &a = ensemble_.body(body), &b = ensemble_.body(other);
  const Material &of_a = ensemble_.material(body), &of_b = ensemble_.material(other);
  micro_ = &ensemble_.rougher(body, other);
  random_ = Random(options_.seed ^ (std::uint64_t{a.id} << 32 | b.id));
  force_ = ContactForce(options_.dead_band);
  step_ = last_step_ = ContactStep{};
  is_touching_ = false;
  sliding_ = Sliding{};
  const double inverse = inverse_mass(a) + inverse_mass(b);
  mass_ = inverse > 0 ? 1 / inverse : 1;
  radius_ = 1 / (1 / a.radius_of_curvature + 1 / b.radius_of_curvature);
  if (!std::isfinite(radius_)) radius_ = radius_of_flat_pair;
  modulus_ = effective_modulus(of_a, of_b);
  rebound_ = 1 + of_a.restitution * of_b.restitution;
  micro_level_ = micro_level(of_a.micro, of_b.micro, options_.micro_level);
  // Pairs that share a table do not sound in step.
  distance_ = random_.uniform() * micro_->period();
  sides_[0].body = body;
  sides_[1].body = other;
  sides_[1].sign = -1;
  for (Side& side : sides_) {
    const auto modes = static_cast<std::size_t>(ensemble_.padded_modes(side.body));
    side.blow_gains = std::span(side.blow_room).first(modes);
    side.normal_gains = std::span(side.normal_room).first(modes);
  }
}

void ContactPair::add(const ContactEvent& event, double now) {
  // Times of one step are computed alike and differ by rounding at most.
  if (step_.duration > 0 && std::abs(event.time - step_.time) > 1e-3 * step_.duration) finish_step(now);
  if (step_.duration == 0) {
    step_.time = event.time;
    step_.duration = std::max(event.duration, 1 / options_.sample_rate);
  }
  step_.add(event);
}

void ContactPair::finish_step(double now) {
  if (step_.duration == 0) return;
  if (step_.count == 0) {  // only "end" events
    step_ = ContactStep{};
    if (is_touching_) part(now);
    return;
  }
  const Vec3 impulse = force_.step(step_.impulse);
  const double within = step_.has_begin ? 0.5 : random_.uniform();
  const bool is_first = step_.has_begin || !is_touching_;
  if (is_first || options_.meso == MesoSource::engine_impulses) {
    blow(impulse, std::max(now, step_.start() + within * step_.duration));
  }
  find_gains(step_.main_point().n_g, &Side::normal_gains);
  if (options_.meso == MesoSource::normal_map) follow_path(now);
  slide();
  is_touching_ = true;
  last_step_ = step_;
  step_ = ContactStep{};
}

void ContactPair::part(double now) {
  step_ = last_step_;
  step_.has_begin = false;
  const Vec3 release = force_.step(Vec3::Zero());
  if (options_.meso == MesoSource::engine_impulses) {
    blow(release, std::max(now, last_step_.time + random_.uniform() * last_step_.duration));
  }
  step_ = ContactStep{};
  is_touching_ = false;
  sliding_ = Sliding{};
}

// The gains of both bodies for a push along `direction` that is shared by the points of the step as its
// impulse is.
void ContactPair::find_gains(const Vec3& direction, std::span<float> Side::*gains) {
  for (Side& side : sides_) {
    std::fill((side.*gains).begin(), (side.*gains).end(), 0.0f);
    for (std::size_t i = 0; i < step_.count; ++i) {
      ensemble_.add_gains(side.body, step_.points[i].point, side.sign * direction, step_.share(i),
                          side.*gains);
    }
  }
}

// The speed of approach is what the impulse tells: J = m* v (1 + e).
HalfSine ContactPair::shape_of(double impulse, double start) const {
  const double speed = std::abs(impulse) / (mass_ * rebound_);
  return {start, hertz_contact_duration(mass_, radius_, modulus_, speed)};
}

void ContactPair::blow(const Vec3& impulse, double start) {
  const double size = impulse.norm();
  if (size == 0 || step_.count == 0) return;
  find_gains(impulse / size, &Side::blow_gains);
  for (const Side& side : sides_) ensemble_.strike(side.body, side.blow_gains, shape_of(size, start), size);
}

void ContactPair::follow_path(double now) {
  const auto& surface = ensemble_.body(other()).surface;
  const ContactEvent& point = is_touching_ ? step_.nearest_point(uv_) : step_.main_point();
  const Vec2 from = uv_;
  uv_ = point.uv;
  const bool is_path = is_touching_ && (point.uv - from).cwiseAbs().maxCoeff() <= longest_path;
  if (!surface || step_.has_begin || !is_path) return;
  std::array<MesoImpulse, max_crossings> crossings;
  const MesoWalk walk =
      walk_texels(*surface, from, point.uv, ensemble_.body(body()).mass, point.v_t, crossings);
  if (!walk.is_complete) ++truncated_paths_;
  for (std::size_t i = 0; i < walk.count; ++i) {
    const double impulse = crossings[i].impulse.dot(surface->placement().n());
    const double start = std::max(now, step_.start() + crossings[i].fraction * step_.duration);
    for (const Side& side : sides_)
      ensemble_.strike(side.body, side.normal_gains, shape_of(impulse, start), impulse);
  }
}

void ContactPair::slide() {
  const double force = std::max(0.0, step_.normal_impulse) / step_.duration;
  const double speed = step_.main_point().v_t.norm();
  const bool goes_on = is_touching_ && !step_.has_begin;
  sliding_.start = step_.start();
  sliding_.end = step_.time;
  // The force of a first touch is the blow's, and has been heard.
  sliding_.force_from = goes_on ? sliding_.force_to : 0;
  sliding_.force_to = goes_on ? force : 0;
  sliding_.speed_from = is_touching_ ? sliding_.speed_to : speed;
  sliding_.speed_to = speed;
}

void ContactPair::drive(std::int64_t first, std::size_t samples) {
  if (micro_level_ == 0 || std::max(sliding_.force_from, sliding_.force_to) == 0) return;
  if (std::max(sliding_.speed_from, sliding_.speed_to) == 0) return;
  const double dt = 1 / options_.sample_rate;
  for (std::size_t k = 0; k < samples; ++k) {
    const double time = static_cast<double>(first + static_cast<std::int64_t>(k)) * dt;
    const double t = std::clamp((time - sliding_.start) / (sliding_.end - sliding_.start), 0.0, 1.0);
    const double force = sliding_.force_from + t * (sliding_.force_to - sliding_.force_from);
    const double speed = sliding_.speed_from + t * (sliding_.speed_to - sliding_.speed_from);
    // Past its last step a contact rests (its body sleeps) until a further step or its end is reported: the
    // noise dies away, slowly enough not to click.
    const double rest = std::clamp((time - sliding_.end) / resting_fade, 0.0, 1.0);
    const double fade = 0.5 + 0.5 * std::cos(std::numbers::pi * rest);
    const double from = distance_;
    distance_ += speed * fade * dt;
    noise_[k] = speed > 0 && rest < 1
                    ? static_cast<float>(micro_level_ * force * fade * micro_->mean(from, distance_) * dt)
                    : 0.0f;
  }
  for (const Side& side : sides_) {
    if (side.normal_gains.empty()) continue;
    ensemble_.drive(side.body, {side.normal_gains, std::span(noise_).first(samples), 0});
  }
}

}  // namespace intaglio::sound
