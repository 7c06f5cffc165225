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
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "intaglio/core/vec.h"
#include "intaglio/sound/micro.h"
#include "intaglio/surface/surface.h"

namespace intaglio::sound {

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
