#include "intaglio/sound/contact_pair.h"

#include <algorithm>
#include <cmath>

#include "intaglio/sound/curvature.h"
#include "intaglio/sound/meso.h"

namespace intaglio::sound {

namespace {

constexpr std::size_t max_crossings = 256;
constexpr double longest_path = 0.25;  // of the texture, in one step; more is a jump

double inverse_mass(const SoundBody& body) {
  return body.is_fixed ? 0 : 1 / body.mass;
}

}  // namespace

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
  random_ = Random(options_.seed ^ (std::uint64_t{a.id} << 32 | b.id));
  force_ = ContactForce(options_.dead_band);
  step_ = last_step_ = ContactStep{};
  is_touching_ = false;
  const double inverse = inverse_mass(a) + inverse_mass(b);
  mass_ = inverse > 0 ? 1 / inverse : 1;
  radius_ = contact_radius(a.radius_of_curvature, b.radius_of_curvature);
  modulus_ = effective_modulus(of_a, of_b);
  rebound_ = 1 + of_a.restitution * of_b.restitution;
  const auto rough = [&](int i) {
    const MicroNoise& noise = ensemble_.noise(i);
    // Bodies that share a table do not sound in step.
    return RubbingBody{&noise, micro_level(ensemble_.material(i).micro, options_.micro_level),
                       random_.uniform() * noise.period()};
  };
  rubbing_.meet({rough(body), rough(other)}, options_.meso == MesoSource::height ? b.surface.get() : nullptr,
                a.mass);
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
  const bool is_first = step_.has_begin || !is_touching_;
  const ContactEvent& point = is_touching_ ? step_.nearest_point(uv_) : step_.main_point();
  uv_from_ = uv_;
  uv_ = point.uv;
  find_radius(point);
  if (is_first || options_.meso == MesoSource::engine_impulses) {
    const double within = step_.touch().value_or(step_.has_begin ? 0.5 : place_within());
    blow(impulse, std::max(now, step_.start() + within * step_.duration));
  }
  find_gains(step_.main_point().n_g, &Side::normal_gains);
  if (options_.meso == MesoSource::normal_map && finds_path()) cross_texels(now);
  rub(point);
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
  rubbing_.part();
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

// Where the relief is what the engine meets, its curvature decides how hard a blow is.
void ContactPair::find_radius(const ContactEvent& point) {
  const SoundBody &a = ensemble_.body(body()), &b = ensemble_.body(other());
  if (!b.surface || options_.meso == MesoSource::normal_map) return;
  radius_ =
      contact_radius(a.radius_of_curvature, b.radius_of_curvature, relief_curvature(*b.surface, point.uv, 0));
}

// Whether the contact went from where it was to where it is along the surface: more than a quarter of the
// texture is a jump.
bool ContactPair::finds_path() {
  const bool goes_on = is_touching_ && !step_.has_begin;
  return goes_on && ensemble_.body(other()).surface && (uv_ - uv_from_).cwiseAbs().maxCoeff() <= longest_path;
}

void ContactPair::cross_texels(double now) {
  const surface::Surface& surface = *ensemble_.body(other()).surface;
  std::array<MesoImpulse, max_crossings> crossings;
  const MesoWalk walk = walk_texels(surface, uv_from_, uv_, ensemble_.body(body()).mass,
                                    step_.nearest_point(uv_).v_t, crossings);
  if (!walk.is_complete) ++truncated_paths_;
  for (std::size_t i = 0; i < walk.count; ++i) {
    const double impulse = crossings[i].impulse.dot(surface.placement().n());
    const double start = std::max(now, step_.start() + crossings[i].fraction * step_.duration);
    for (const Side& side : sides_)
      ensemble_.strike(side.body, side.normal_gains, shape_of(impulse, start), impulse);
  }
}

// When within its step the engine's blow came, 0..1: when the path crossed the sharpest bend of the texture;
// at a seeded random place when it crossed none, or steps would buzz.
double ContactPair::place_within() {
  const double random = random_.uniform();
  if (!finds_path()) return random;
  std::array<MesoImpulse, max_crossings> crossings;
  const MesoWalk walk = walk_texels(*ensemble_.body(other()).surface, uv_from_, uv_, 1,
                                    step_.nearest_point(uv_).v_t, crossings);
  const auto end = crossings.begin() + static_cast<std::ptrdiff_t>(walk.count);
  const auto sharpest = std::max_element(crossings.begin(), end, [](const auto& a, const auto& b) {
    return a.impulse.squaredNorm() < b.impulse.squaredNorm();
  });
  return sharpest == end || sharpest->impulse.isZero() ? random : sharpest->fraction;
}

void ContactPair::rub(const ContactEvent& point) {
  ContactMotion to = contact_motion(point.v_t, point.spin);
  to.force = std::max(0.0, step_.normal_impulse) / step_.duration;
  to.uv = uv_;
  if (const auto& surface = ensemble_.body(other()).surface)
    to.velocity = surface->placement().direction_to_local(point.v_t).head<2>();
  rubbing_.set_footprint(2 * hertz_patch_radius(to.force, radius_, modulus_));
  if (is_touching_ && !step_.has_begin) {
    rubbing_.step(step_.start(), step_.time, to, finds_path());
  } else {
    rubbing_.touch(step_.start(), step_.time, to);
  }
}

void ContactPair::drive(std::int64_t first, std::size_t samples) {
  const std::span<float> noise = std::span(noise_).first(samples);
  if (!rubbing_.sample(first, 1 / options_.sample_rate, noise)) return;
  for (const Side& side : sides_) {
    if (!side.normal_gains.empty()) ensemble_.drive(side.body, {side.normal_gains, noise, 0});
  }
}

}  // namespace intaglio::sound
