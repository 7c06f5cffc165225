#include "sound/contact_pair.h"

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "sound/impact.h"

namespace intaglio::sound {

namespace {

constexpr double max_jump = 0.25;   // of the texture's size, from the position predicted by its speed
constexpr double max_wraps = 1000;  // in one step

double inverse_mass(const SoundBody& body) {
  return body.is_fixed ? 0 : 1 / body.mass;
}

const surface::Surface* texture_of(const SoundBody& body, int k) {
  const bool has = k >= 0 && std::size_t(k) < body.textures.size();
  return has ? body.textures[std::size_t(k)].get() : nullptr;
}
ReliefPoint point_on_body(const SoundBody& body, const ContactEvent& event) {
  if (!event.own) return {};
  return {texture_of(body, event.own->texture), event.own->uv, event.own->sweep};
}
ReliefPoint point_on_other(const SoundBody& other, const ContactEvent& event) {
  const surface::Surface* const surface = texture_of(other, event.texture);
  if (!surface) return {};
  const Vec2 along = surface->placement().direction_to_local(event.v_t).head<2>();
  return {surface, event.uv, event.sweep.value_or(along)};
}

}  // namespace

ContactPair::ContactPair(Ensemble& ensemble, const SynthesizerOptions& options)
    : ensemble_(ensemble), options_(options), splitter_(options.dead_band) {
  for (Side& side : sides_) {
    side.strike_storage.resize(std::size_t(ensemble.max_padded_modes()));
    side.normal_storage.resize(side.strike_storage.size());
  }
}

void ContactPair::assign(int body, int other) {
  const SoundBody &a = ensemble_.body(body), &b = ensemble_.body(other);
  const Material &of_a = ensemble_.material(body), &of_b = ensemble_.material(other);
  random_ = Random(options_.seed ^ (std::uint64_t{a.id} << 32 | b.id));
  splitter_ = ImpulseSplitter(options_.dead_band);
  step_ = last_step_ = ContactStep{};
  is_touching_ = false;
  const double inverse = inverse_mass(a) + inverse_mass(b);
  mass_ = inverse > 0 ? 1 / inverse : 1;
  radius_ = contact_radius(a.radius_of_curvature, b.radius_of_curvature);
  modulus_ = effective_modulus(of_a, of_b);
  one_plus_restitution_ = 1 + of_a.restitution * of_b.restitution;
  const auto roughness = [&](int i) {
    const MicroNoise& noise = ensemble_.noise(i);
    // Random offsets decorrelate bodies that share a noise table.
    return RubbingBody{&noise, micro_level(ensemble_.material(i).micro, options_.micro_level),
                       random_.uniform() * noise.period()};
  };
  rubbing_.reset({roughness(body), roughness(other)}, mass_);
  sides_[0].body = body;
  sides_[1].body = other;
  sides_[1].sign = -1;
  for (Side& side : sides_) {
    side.to = {};
    const auto modes = std::size_t(ensemble_.padded_modes(side.body));
    side.strike_gains = std::span(side.strike_storage).first(modes);
    side.normal_gains = std::span(side.normal_storage).first(modes);
  }
}

void ContactPair::add(const ContactEvent& event, double now) {
  // Events of one step differ in time by rounding only.
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
    if (is_touching_) release(now);
    return;
  }
  const Vec3 impulse = splitter_.split(step_.impulse);
  const bool is_first = step_.has_begin || !is_touching_;
  const ContactEvent& point = is_touching_ ? step_.nearest_point(contact_point_) : step_.main_point();
  update_paths(point);
  find_radius();
  if (is_first || options_.meso == MesoSource::engine_impulses) {
    const double within = step_.first_touch().value_or(step_.has_begin ? 0.5 : strike_fraction());
    strike(step_, impulse, std::max(now, step_.start() + within * step_.duration));
  }
  find_gains(step_, step_.main_point().n_g, &Side::normal_gains);
  if (options_.meso == MesoSource::normal_map) cross_texels(now);
  update_rubbing(point);
  is_touching_ = true;
  last_step_ = step_;
  step_ = ContactStep{};
}

// The release strikes where the last step's points were.
void ContactPair::release(double now) {
  const Vec3 impulse = splitter_.split(Vec3::Zero());
  if (options_.meso == MesoSource::engine_impulses) {
    strike(last_step_, impulse, std::max(now, last_step_.time + random_.uniform() * last_step_.duration));
  }
  step_ = ContactStep{};
  is_touching_ = false;
  rubbing_.release();
}

// Gains of both bodies for a push along `direction`, distributed over the step's points by impulse.
void ContactPair::find_gains(const ContactStep& step, const Vec3& direction, std::span<float> Side::*gains) {
  for (Side& side : sides_) {
    std::fill((side.*gains).begin(), (side.*gains).end(), 0.0f);
    for (std::size_t i = 0; i < step.count; ++i) {
      ensemble_.add_gains(side.body, step.points[i].point, side.sign * direction, step.impulse_share(i),
                          side.*gains);
    }
  }
}

// Approach speed from the impulse: J = m* v (1 + e).
HalfSine ContactPair::pulse_shape(double impulse, double start) const {
  const double speed = std::abs(impulse) / (mass_ * one_plus_restitution_);
  return {start, hertz_contact_duration(mass_, radius_, modulus_, speed)};
}

void ContactPair::strike(const ContactStep& step, const Vec3& impulse, double start) {
  const double size = impulse.norm();
  if (size == 0 || step.count == 0) return;
  find_gains(step, impulse / size, &Side::strike_gains);
  for (const Side& side : sides_)
    ensemble_.strike(side.body, side.strike_gains, pulse_shape(size, start), size);
}

// If the engine collides with the relief itself, its curvature sets the contact radius.
void ContactPair::find_radius() {
  if (options_.meso == MesoSource::normal_map) return;
  double curvature = 0;
  for (const Side& side : sides_)
    if (side.to.surface) curvature += relief_curvature(*side.to.surface, side.to.uv, 0);
  radius_ = contact_radius(ensemble_.body(body()).radius_of_curvature,
                           ensemble_.body(other()).radius_of_curvature, curvature);
}

// The path continues to `to` if that is on the same texture and near where the contact's speed led. Across
// the seam of a texture that wraps round its body, uv is continued, provided that the contact did not jump in
// the world.
void ContactPair::follow_path(Side& side, const ReliefPoint& to, double distance_moved) {
  const surface::Surface* const surface = to.surface;
  side.follows_path = is_touching_ && !step_.has_begin && surface && surface == side.to.surface;
  side.from = side.to.uv;
  side.to = to;
  if (!side.follows_path) return;
  const Vec2 size = surface->placement().size();
  Vec2 jump = to.uv - side.from - step_.duration * to.sweep.cwiseQuotient(size);
  if (surface->edge() == surface::Edge::wrap && jump.cwiseAbs().maxCoeff() < max_wraps &&
      distance_moved <= step_.duration * to.sweep.norm() + max_jump * size.minCoeff()) {
    const Vec2 wraps = jump.array().round();
    side.to.uv -= wraps;
    jump -= wraps;
  }
  side.follows_path = jump.allFinite() && jump.cwiseAbs().maxCoeff() <= max_jump;
}

void ContactPair::update_paths(const ContactEvent& point) {
  const double distance_moved = (point.point - contact_point_).norm();
  contact_point_ = point.point;
  follow_path(sides_[0], point_on_body(ensemble_.body(body()), point), distance_moved);
  follow_path(sides_[1], point_on_other(ensemble_.body(other()), point), distance_moved);
  // Without a reported sweep the velocity may lag; a large change of uv counts as a jump.
  Side& still = sides_[1];
  if (!point.sweep) still.follows_path &= (still.to.uv - still.from).cwiseAbs().maxCoeff() <= max_jump;
}

MesoWalk ContactPair::walk(const Side& side, double mass) {
  if (!side.follows_path) return {};
  return walk_texels(*side.to.surface, side.from, side.to.uv, mass, side.to.sweep, crossings_);
}

// A bump of either body pushes both apart.
void ContactPair::cross_texels(double now) {
  for (const Side& swept : sides_) {
    const MesoWalk crossed = walk(swept, mass_);
    if (!crossed.is_complete) ++truncated_paths_;
    for (const MesoImpulse& hit : std::span(crossings_).first(crossed.count)) {
      const double start = std::max(now, step_.start() + hit.fraction * step_.duration);
      for (const Side& side : sides_)
        ensemble_.strike(side.body, side.normal_gains, pulse_shape(hit.impulse, start), hit.impulse);
    }
  }
}

// Fraction of the step at which the engine's impulse came: where the path crossed the largest change of
// slope, or, if it crossed none, a seeded random one, because a fixed fraction would buzz at the step rate.
double ContactPair::strike_fraction() {
  MesoImpulse sharpest{random_.uniform(), 0};
  for (const Side& swept : sides_) {
    for (const MesoImpulse& hit : std::span(crossings_).first(walk(swept, 1).count))
      if (std::abs(hit.impulse) > std::abs(sharpest.impulse)) sharpest = hit;
  }
  return sharpest.fraction;
}

void ContactPair::update_rubbing(const ContactEvent& point) {
  ContactMotion to = contact_motion(point.v_t, point.spin);
  to.force = std::max(0.0, step_.normal_impulse) / step_.duration;
  if (options_.meso == MesoSource::height) to.relief = {sides_[0].to, sides_[1].to};
  rubbing_.set_footprint(2 * hertz_patch_radius(to.force, radius_, modulus_));
  if (is_touching_ && !step_.has_begin) {
    rubbing_.step(step_.start(), step_.time, to, {sides_[0].follows_path, sides_[1].follows_path});
  } else {
    rubbing_.begin(step_.start(), step_.time, to);
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
