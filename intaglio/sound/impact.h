// How a blow is spread over time: Hertz contact duration, and the half-sine pulse of that duration.
//
// Pure functions, SI units, any thread. Source: Johnson, "Contact Mechanics", 1985, §11.4; a half-sine of
// impulse J has peak force pi J / (2 tau) and its first spectral zero at 1.5 / tau, so hard, small and fast
// contacts sound bright.
#pragma once

#include <span>

#include "intaglio/core/material.h"

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

}  // namespace intaglio::sound
