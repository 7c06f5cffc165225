// Micro-level sound: fractal noise for the roughness that no texture shows (§1.2.5.1).
//
// The noise is a function of the distance travelled, so its pitch follows the speed by itself; its level is
// proportional to the normal force. A table of one period, of unit rms and zero mean, is made once: the power
// spectral density is flat up to the wavenumber 1 / correlation_length (rad/m) and falls with the material's
// spectral slope above it. Immutable, any thread, no allocation in a sample. Source: van den Doel, Kry, Pai,
// "FoleyAutomatic", 2001; Ren, Yeh, Lin, 2010.
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

class MicroNoise {
 public:
  static constexpr int table_size = 1 << 15;
  static constexpr double points_per_correlation = 8;

  MicroNoise(const MicroRoughness& roughness, std::uint64_t seed);

  // Distance between table points, and the distance after which the noise repeats (4,096 correlation
  // lengths), m.
  double spacing() const { return spacing_; }
  double period() const { return spacing_ * table_size; }

  // The noise at `distance` (m, any sign), linear between table points.
  double sample(double distance) const;
  // Its mean over the way from `from` to `to`: what a sample of audio is given. However long the way, nothing
  // aliases: what is shorter than it averages out. The cost does not depend on the way.
  double mean(double from, double to) const;

 private:
  double integral(double distance) const;

  double spacing_;
  std::vector<float> table_;
  std::vector<double> integral_;  // up to each table point, in units of spacing
};

// Force noise per normal force: how much of the normal force becomes noise, rms, where a surface of that
// roughness is scraped: `level` times its rms slope, rms_height / correlation_length.
double micro_level(const MicroRoughness& roughness, double level);

// Meso-level sound: the bumps a normal map shows, met by a body that slides or rolls over them (§1.2.5.1).
//
// Pure, any thread, no allocation. While a body follows the map its momentum across the coarse face is p_n;
// whenever its contact point comes to a new texel, the difference is an impulse.

// n_g . n_s is taken to be at least this: the momentum on a slope of more than about 84 degrees stays finite.
inline constexpr double least_normal_cosine = 0.1;

// p_n = m (-v_t . n_s / n_g . n_s) n_g, kg m/s: the momentum across the face of a body of `mass` (kg) that
// moves with v_t (m/s) along a face of unit normal n_g where the texel's unit normal is n_s.
// Eq. 1.4, Sterling & Lin 2016, §1.2.5.1
Vec3 normal_momentum(double mass, const Vec3& v_t, const Vec3& n_g, const Vec3& n_s);

struct MesoImpulse {
  double fraction = 0;  // when within the step: 0 start, 1 end
  double impulse = 0;   // N s, along n_g: what parts the bodies is positive
};

struct MesoWalk {
  std::size_t count = 0;    // impulses written
  bool is_complete = true;  // false when there were more crossings than room; the rest are left out
};

// Visits each texel that the straight path from uv0 to uv1 crosses, in order, and writes the impulse of each
// crossing to `out`. `sweep`: v_t along u and v, m/s; wherever the surface lies and whatever it is bent
// round, its own frame is all that counts. The path may leave 0..1; the surface wraps or clamps. Cost: two
// texels a crossing. Source of the traversal: Amanatides & Woo, "A fast voxel traversal algorithm for ray
// tracing", 1987.
MesoWalk walk_texels(const surface::Surface& surface, const Vec2& uv0, const Vec2& uv1, double mass,
                     const Vec2& sweep, std::span<MesoImpulse> out);

// What lasts in a contact, as a force at audio rate: the roughness of both surfaces (micro) and, when asked
// for, the relief under the contact patch (meso by height).
//
// The contact sweeps over each of the two bodies with a speed of its own, and the bodies slip past each other
// with the vector difference: a pen that is dragged sweeps over the floor only; a ball that rolls sweeps over
// both and does not slip; all between is covered by the same formula, with no switch. Each body's noise is
// read at the distance swept over it. Roughness that is swept without slip is pressed, not scraped, and
// counts a quarter. The relief of either body gives the momentum across the face of Eq. 1.4, with the slope
// of the height under the patch; a contact can push but not pull, so what would lift the body harder than the
// normal force holds it is left out. SI units. One thread; nothing here allocates, locks or throws.

// Where a contact is on a body's relief.
struct ReliefPlace {
  const surface::Surface* surface = nullptr;  // null: none that sounds
  Vec2 uv = Vec2::Zero();                     // not wrapped
  Vec2 sweep = Vec2::Zero();                  // m/s, along u and v
};

// How a contact moves at one instant.
struct ContactMotion {
  double force = 0;                     // N, normal
  std::array<double, 2> sweep{};        // m/s, of the contact over the surface of each body
  double slip = 0;                      // m/s, of one surface past the other
  std::array<ReliefPlace, 2> relief{};  // of each body
};

// Of a body whose surface moves at `v_t` (its centre) and `spin` (its turning, where it touches), on one at
// rest: sweep over the body, over the other, and slip.
ContactMotion contact_motion(const Vec3& v_t, const Vec3& spin);

// How much of a noise counts that is swept at `sweep` while the bodies slip at `slip`.
double scraped_share(double sweep, double slip);

struct RubbingBody {
  const MicroNoise* noise = nullptr;
  double level = 0;     // noise force per normal force when scraped
  double distance = 0;  // m, swept so far
};

class Rubbing {
 public:
  // `mass` is what follows a relief, kg: the effective one of both bodies.
  void meet(const std::array<RubbingBody, 2>& bodies, double mass) { *this = Rubbing(bodies, mass); }
  // From `start` to `end` the motion goes evenly from where it was to `to`. `follows_path`, of each body: uv
  // on its relief too; else that begins at `to`.
  void step(double start, double end, const ContactMotion& to, const std::array<bool, 2>& follows_path);
  // The force of a first touch is the blow's, and has been heard: it does not count here.
  void touch(double start, double end, ContactMotion to);
  void part() { *this = Rubbing(bodies_, mass_); }
  // Diameter over which the relief is felt, m.
  void set_footprint(double footprint) { footprint_ = footprint; }

  // Impulses (N s) of the samples from number `first` on. False when all are zero; then nothing is written.
  bool sample(std::int64_t first, double dt, std::span<float> out);

 private:
  Rubbing(const std::array<RubbingBody, 2>& bodies, double mass) : bodies_(bodies), mass_(mass) {}
  double micro(const ContactMotion& now, double fade, double dt);
  double meso(const ContactMotion& now, double fade, double dt);
  ContactMotion at(double t) const;

 public:
  Rubbing() = default;

 private:
  std::array<RubbingBody, 2> bodies_;
  double mass_ = 0, footprint_ = 0;
  double start_ = 0, end_ = 0;  // s
  ContactMotion from_, to_;
  std::array<std::optional<double>, 2> momentum_;  // kg m/s, from each relief
};

}  // namespace intaglio::sound
