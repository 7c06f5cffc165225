#include "sound/contact_pair.h"

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "sound/impact.h"

namespace intaglio::sound {

namespace {

constexpr double longest_jump = 0.25;  // of the texture, off the way that its speed foretells
constexpr double most_turns = 1000;    // round it, in one step

double inverse_mass(const SoundBody& body) {
  return body.is_fixed ? 0 : 1 / body.mass;
}

const surface::Surface* texture_of(const SoundBody& body, int k) {
  const bool has = k >= 0 && static_cast<std::size_t>(k) < body.textures.size();
  return has ? body.textures[static_cast<std::size_t>(k)].get() : nullptr;
}
ReliefPlace place_on_body(const SoundBody& body, const ContactEvent& event) {
  if (!event.own) return {};
  return {texture_of(body, event.own->texture), event.own->uv, event.own->sweep};
}
ReliefPlace place_on_other(const SoundBody& other, const ContactEvent& event) {
  const surface::Surface* const surface = texture_of(other, event.texture);
  if (!surface) return {};
  const Vec2 along = surface->placement().direction_to_local(event.v_t).head<2>();
  return {surface, event.uv, event.sweep.value_or(along)};
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
  rubbing_.meet({rough(body), rough(other)}, mass_);
  sides_[0].body = body;
  sides_[1].body = other;
  sides_[1].sign = -1;
  for (Side& side : sides_) {
    side.to = {};
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
  const ContactEvent& point = is_touching_ ? step_.nearest_point(place_) : step_.main_point();
  follow(point);
  find_radius();
  if (is_first || options_.meso == MesoSource::engine_impulses) {
    const double within = step_.touch().value_or(step_.has_begin ? 0.5 : place_within());
    blow(impulse, std::max(now, step_.start() + within * step_.duration));
  }
  find_gains(step_.main_point().n_g, &Side::normal_gains);
  if (options_.meso == MesoSource::normal_map) cross_texels(now);
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
void ContactPair::find_radius() {
  if (options_.meso == MesoSource::normal_map) return;
  double curvature = 0;
  for (const Side& side : sides_)
    if (side.to.surface) curvature += relief_curvature(*side.to.surface, side.to.uv, 0);
  radius_ = contact_radius(ensemble_.body(body()).radius_of_curvature,
                           ensemble_.body(other()).radius_of_curvature, curvature);
}

// The contact goes on to `to` when its speed led it near there: not to another texture, nor far off. Across
// the seam of a texture that goes round its body uv runs on, where the contact did not leap in the world.
void ContactPair::follow(Side& side, const ReliefPlace& to, double leap) {
  const surface::Surface* const surface = to.surface;
  side.follows_path = is_touching_ && !step_.has_begin && surface && surface == side.to.surface;
  side.from = side.to.uv;
  side.to = to;
  if (!side.follows_path) return;
  const Vec2 size = surface->placement().size();
  Vec2 jump = to.uv - side.from - step_.duration * to.sweep.cwiseQuotient(size);
  if (surface->edge() == surface::Edge::wrap && jump.cwiseAbs().maxCoeff() < most_turns &&
      leap <= step_.duration * to.sweep.norm() + longest_jump * size.minCoeff()) {
    const Vec2 turns = jump.array().round();
    side.to.uv -= turns;
    jump -= turns;
  }
  side.follows_path = jump.allFinite() && jump.cwiseAbs().maxCoeff() <= longest_jump;
}

void ContactPair::follow(const ContactEvent& point) {
  const double leap = (point.point - place_).norm();
  place_ = point.point;
  follow(sides_[0], place_on_body(ensemble_.body(body()), point), leap);
  follow(sides_[1], place_on_other(ensemble_.body(other()), point), leap);
  // On a rectangle that lies still, who tells no sweep may be late: what is far is a leap.
  Side& still = sides_[1];
  if (!point.sweep) still.follows_path &= (still.to.uv - still.from).cwiseAbs().maxCoeff() <= longest_jump;
}

MesoWalk ContactPair::walk(const Side& side, double mass) {
  if (!side.follows_path) return {};
  return walk_texels(*side.to.surface, side.from, side.to.uv, mass, side.to.sweep, crossings_);
}

// A bump of either body drives both apart.
void ContactPair::cross_texels(double now) {
  for (const Side& swept : sides_) {
    const MesoWalk way = walk(swept, mass_);
    if (!way.is_complete) ++truncated_paths_;
    for (const MesoImpulse& hit : std::span(crossings_).first(way.count)) {
      const double start = std::max(now, step_.start() + hit.fraction * step_.duration);
      for (const Side& side : sides_)
        ensemble_.strike(side.body, side.normal_gains, shape_of(hit.impulse, start), hit.impulse);
    }
  }
}

// When within its step the engine's blow came, 0..1: when the way crossed the sharpest bend of a texture; at
// a seeded random place when it crossed none, or steps would buzz.
double ContactPair::place_within() {
  MesoImpulse sharpest{random_.uniform(), 0};
  for (const Side& swept : sides_) {
    for (const MesoImpulse& hit : std::span(crossings_).first(walk(swept, 1).count))
      if (std::abs(hit.impulse) > std::abs(sharpest.impulse)) sharpest = hit;
  }
  return sharpest.fraction;
}

void ContactPair::rub(const ContactEvent& point) {
  ContactMotion to = contact_motion(point.v_t, point.spin);
  to.force = std::max(0.0, step_.normal_impulse) / step_.duration;
  if (options_.meso == MesoSource::height) to.relief = {sides_[0].to, sides_[1].to};
  rubbing_.set_footprint(2 * hertz_patch_radius(to.force, radius_, modulus_));
  if (is_touching_ && !step_.has_begin) {
    rubbing_.step(step_.start(), step_.time, to, {sides_[0].follows_path, sides_[1].follows_path});
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
