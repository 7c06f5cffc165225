// Sustained contact force at audio rate, from the roughness of both surfaces (micro) and, if selected, from
// the relief under the contact patch (meso by height). Three sections: the noise, the bumps of a normal map,
// and Rubbing, which combines them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "intaglio/material.h"
#include "intaglio/vec.h"
#include "surface/surface.h"

namespace intaglio::sound {

// Micro-level sound: fractal noise for the roughness that no texture shows (§1.2.5.1).
//
// The noise is a function of the distance travelled, so its pitch follows the speed; its level is
// proportional to the normal force. A table of one period, of unit rms and zero mean, is built once. Its
// power spectral density at the wavenumber k (rad/m) is
//   S(k) proportional to max(1, k L)^p,   L: correlation_length, p: spectral_slope of the material.
// Immutable, any thread, no allocation per sample. Source: van den Doel, Kry, Pai, "FoleyAutomatic", 2001;
// Ren, Yeh, Lin, 2010.

class MicroNoise {
 public:
  static constexpr int table_size = 1 << 15;
  static constexpr double points_per_correlation = 8;

  MicroNoise(const MicroRoughness& roughness, std::uint64_t seed);

  // Distance between table points, and the period of the noise (4,096 correlation lengths), m.
  double spacing() const { return spacing_; }
  double period() const { return spacing_ * table_size; }

  // The noise at `distance` (m, any sign), linear between table points.
  double sample(double distance) const;
  // Its mean from `from` to `to`, the value of an audio sample. Averaging over the interval avoids aliasing
  // at any speed. The cost does not depend on the distance.
  double mean(double from, double to) const;

 private:
  double integral(double distance) const;

  double spacing_;
  std::vector<float> table_;
  std::vector<double> integral_;  // up to each table point, in units of spacing
};

// RMS force noise per unit normal force of a scraped surface of that roughness: `level` times its rms slope,
// rms_height / correlation_length.
double micro_level(const MicroRoughness& roughness, double level);

// Meso-level sound: impulses from the bumps of a normal map under a sliding or rolling body (§1.2.5.1).
//
// Pure, any thread, no allocation. While a body follows the map, its momentum across the coarse face is p_n;
// whenever its contact point reaches a new texel, the difference is an impulse.

// n_g . n_s is taken to be at least this: the momentum on a slope of more than about 84 degrees stays finite.
inline constexpr double min_normal_cosine = 0.1;

// p_n = m (-v_t . n_s / n_g . n_s) n_g, kg m/s: the momentum across the face of a body of `mass` (kg) that
// moves with v_t (m/s) along a face of unit normal n_g where the texel's unit normal is n_s.
// Eq. 1.4, Sterling & Lin 2016, §1.2.5.1
Vec3 normal_momentum(double mass, const Vec3& v_t, const Vec3& n_g, const Vec3& n_s);

struct MesoImpulse {
  double fraction = 0;  // of the step: 0 start, 1 end
  double impulse = 0;   // N s, along n_g: positive pushes the bodies apart
};

struct MesoWalk {
  std::size_t count = 0;    // impulses written
  bool is_complete = true;  // false if there were more crossings than room for; the rest are dropped
};

// Visits each texel that the straight path from uv0 to uv1 crosses, in order, and writes the impulse of each
// crossing to `out`. `sweep`: v_t along u and v, m/s; only the surface's own frame matters. The path may
// leave 0..1; the surface wraps or clamps. Cost: two texels per crossing. Source of the traversal: Amanatides
// & Woo, "A fast voxel traversal algorithm for ray tracing", 1987.
MesoWalk walk_texels(const surface::Surface& surface, const Vec2& uv0, const Vec2& uv1, double mass,
                     const Vec2& sweep, std::span<MesoImpulse> out);

// The sustained force of one contact.
//
// The contact sweeps over each of the two bodies with a speed of its own, and the bodies slip past each other
// with the vector difference: a dragged pen sweeps over the floor only; a rolling ball sweeps over both and
// does not slip; one formula covers every case in between. Each body's noise is read at the distance swept
// over it. Roughness that is swept without slip counts a quarter (pressed, not scraped). The relief of either
// body gives the momentum across the face of Eq. 1.4, with the slope of the height under the patch; a contact
// can push but not pull, so the impulse is clamped where it would lift the body harder than the normal force
// holds it. SI units. One thread; nothing here allocates, locks or throws.

// Position of a contact on a body's relief.
struct ReliefPoint {
  const surface::Surface* surface = nullptr;  // null: none, or a silent one
  Vec2 uv = Vec2::Zero();                     // not wrapped
  Vec2 sweep = Vec2::Zero();                  // m/s, along u and v
};

// Motion of a contact at one instant.
struct ContactMotion {
  double force = 0;                     // N, normal
  std::array<double, 2> sweep{};        // m/s, of the contact over the surface of each body
  double slip = 0;                      // m/s, of one surface past the other
  std::array<ReliefPoint, 2> relief{};  // of each body
};

// Sweep over both bodies, and slip, for a body whose centre moves at `v_t` and whose rotation adds `spin` at
// the contact, on a body at rest.
ContactMotion contact_motion(const Vec3& v_t, const Vec3& spin);

// Share of a noise that is heard when it is swept at `sweep` while the bodies slip at `slip`.
double scraped_share(double sweep, double slip);

struct RubbingBody {
  const MicroNoise* noise = nullptr;
  double level = 0;     // noise force per normal force when scraped
  double distance = 0;  // m, swept so far
};

class Rubbing {
 public:
  Rubbing() = default;
  // `mass`: kg, that follows a relief: the effective one of both bodies.
  void reset(const std::array<RubbingBody, 2>& bodies, double mass) { *this = Rubbing(bodies, mass); }
  // From `start` to `end` the motion changes linearly to `to`. `follows_path`, for each body: whether uv on
  // its relief does so, too; otherwise it is that of `to` throughout.
  void step(double start, double end, const ContactMotion& to, const std::array<bool, 2>& follows_path);
  // The first step's force is already heard as an impact, so it is ignored here.
  void begin(double start, double end, ContactMotion to);
  void release() { *this = Rubbing(bodies_, mass_); }
  // Diameter over which the relief is averaged, m.
  void set_footprint(double footprint) { footprint_ = footprint; }

  // Impulses (N s) of the samples from number `first` on. False if all are zero; then nothing is written.
  bool sample(std::int64_t first, double dt, std::span<float> out);

 private:
  Rubbing(const std::array<RubbingBody, 2>& bodies, double mass) : bodies_(bodies), mass_(mass) {}
  double micro(const ContactMotion& now, double fade, double dt);
  double meso(const ContactMotion& now, double fade, double dt);
  ContactMotion interpolate(double t) const;

  std::array<RubbingBody, 2> bodies_;
  double mass_ = 0, footprint_ = 0;
  double start_ = 0, end_ = 0;  // s
  ContactMotion from_, to_;
  std::array<std::optional<double>, 2> momentum_;  // kg m/s, from each relief
};

}  // namespace intaglio::sound
