// How a blow is spread over time: Hertz contact duration, and the half-sine pulse of that duration.
//
// Pure functions, SI units, any thread. Source: Johnson, "Contact Mechanics", 1985, §11.4; a half-sine of
// impulse J has peak force pi J / (2 tau) and its first spectral zero at 1.5 / tau, so hard, small and fast
// contacts sound bright.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "intaglio/material.h"
#include "surface/surface.h"

namespace intaglio::sound {

inline constexpr double shortest_contact = 20e-6;  // s
inline constexpr double longest_contact = 50e-3;   // s

// 1 / E* = sum of (1 - nu^2) / E over both bodies, Pa.
double effective_modulus(const Material& a, const Material& b);

// tau = 2.87 (m*^2 / (R E*^2 v))^(1/5), clamped: `mass` m* = 1 / (1/m1 + 1/m2) kg, `radius` R = 1 / (1/r1 +
// 1/r2) m, `modulus` E* Pa, `speed` of approach m/s. No speed gives the longest contact.
double hertz_contact_duration(double mass, double radius, double modulus, double speed);

// a = (3 F R / (4 E*))^(1/3): the radius of the patch over which two bodies touch that are pressed together
// with `force` (N), m.
double hertz_patch_radius(double force, double radius, double modulus);

// A half-sine of unit impulse, from `start` on, for `duration` > 0 (s).
struct HalfSine {
  double start = 0;
  double duration = shortest_contact;

  double end() const { return start + duration; }
  // What has been given by `time`: 0 before the start, 1 after the end.
  double given(double time) const;
  // out[k] = what is given between time + k dt and time + (k+1) dt: the samples of a pulse add up to exactly
  // its impulse, wherever it starts between two of them.
  void sample(double time, double dt, std::span<float> out) const;
};

// How sharply curved two bodies are where they touch: the radius of Hertz contact.
//
// Pure, any thread, no allocation; five readings of the relief, about 0.5 us.

// Mean curvature of the relief at uv, 1/m: positive on a ridge, negative in a groove. `footprint`: the
// diameter in metres over which it is averaged, at least two texels. 0 for a flat surface.
double relief_curvature(const surface::Surface& surface, const Vec2& uv, double footprint);

// 1 / R = 1 / a + 1 / b + curvature, m. Flat bodies have radius infinity. A groove that fits closely counts
// as ten times the smaller radius; two flat bodies meet at an edge of 1 cm; nothing is sharper than 0.1 mm.
double contact_radius(double a, double b, double curvature = 0);

// The blows that are sounding or about to: a fixed number of half-sine pulses, each with the gains of the
// body it strikes.
//
// All memory is taken at construction. One thread; nothing here allocates, locks or throws afterwards.

struct Pulse {
  HalfSine shape;
  double impulse = 0;  // N s
  int body = 0;        // whom it strikes: an index of the caller's
};

class PulsePool {
 public:
  PulsePool(int capacity, int gains_each);

  // A place for one more pulse: its gains, for the caller to fill. When all are taken, the smallest pulse,
  // maybe the new one, is dropped and counted; gains of a dropped new one are empty.
  std::span<float> add(const Pulse& pulse);
  // Forgets the pulses that have ended by `time`.
  void remove_ended(double time);

  int size() const { return static_cast<int>(active_.size()); }
  const Pulse& pulse(int i) const { return pulses_[std::size_t(active_[std::size_t(i)])]; }
  std::span<const float> gains(int i) const;
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::span<float> row(int slot);

  int gains_each_;
  std::vector<Pulse> pulses_;  // by slot
  std::vector<float> gains_;   // by slot
  std::vector<int> active_, free_;
  std::uint64_t dropped_ = 0;
};

}  // namespace intaglio::sound
