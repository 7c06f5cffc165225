// Duration and pulse shape of an impact: Hertz contact, and a half-sine pulse of that duration.
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

inline constexpr double min_contact_duration = 20e-6;  // s
inline constexpr double max_contact_duration = 50e-3;  // s

// E* in 1 / E* = sum of (1 - nu^2) / E over both bodies, Pa.
double effective_modulus(const Material& a, const Material& b);

// tau = 2.87 (m*^2 / (R E*^2 v))^(1/5), clamped, with
//   `mass`     m* = 1 / (1/m1 + 1/m2), kg
//   `radius`   R = 1 / (1/r1 + 1/r2), m
//   `modulus`  E*, Pa
//   `speed`    v of approach, m/s; zero gives the maximum.
double hertz_contact_duration(double mass, double radius, double modulus, double speed);

// a = (3 F R / (4 E*))^(1/3), m: radius of the patch of two bodies pressed together with `force` F, N.
double hertz_patch_radius(double force, double radius, double modulus);

// A half-sine of unit impulse, from `start` on, for `duration` > 0 (s).
struct HalfSine {
  double start = 0;
  double duration = min_contact_duration;

  double end() const { return start + duration; }
  // Fraction of the impulse delivered by `time`: 0 before the start, 1 after the end.
  double impulse_by(double time) const;
  // out[k] = fraction delivered between time + k dt and time + (k+1) dt: the samples of a pulse add up to
  // exactly its impulse, wherever it starts between two of them.
  void sample(double time, double dt, std::span<float> out) const;
};

// Effective radius of curvature of a contact.
//
// Pure, any thread, no allocation; four samples of the relief, about 0.5 us.

// Mean curvature of the relief at uv, 1/m: positive on a ridge, negative in a groove. `footprint`: the
// diameter in metres over which it is averaged, at least two texels. 0 for a flat surface.
double relief_curvature(const surface::Surface& surface, const Vec2& uv, double footprint);

// R in 1 / R = 1 / a + 1 / b + curvature, m. Flat bodies have radius infinity. A closely fitting groove
// counts as ten times the radius without it; two flat bodies touch with an edge of 1 cm; the radius is at
// least 0.1 mm.
double contact_radius(double a, double b, double curvature = 0);

// Active and pending impact pulses: a fixed number of half-sines, each with the gains of the body it strikes.
//
// All memory is allocated at construction. One thread; nothing here allocates, locks or throws afterwards.

struct Pulse {
  HalfSine shape;
  double impulse = 0;  // N s
  int body = 0;        // index of the struck body
};

class PulsePool {
 public:
  PulsePool(int capacity, int gains_each);

  // Adds a pulse and returns its gains, for the caller to fill. If all slots are taken, the smallest pulse,
  // possibly the new one, is dropped and counted; the gains of a dropped new pulse are empty.
  std::span<float> add(const Pulse& pulse);
  // Frees the pulses that have ended by `time`.
  void remove_ended(double time);

  int size() const { return int(active_.size()); }
  const Pulse& pulse(int i) const { return pulses_[std::size_t(active_[std::size_t(i)])]; }
  std::span<const float> gains(int i) const {
    const auto slot = std::size_t(active_[std::size_t(i)]);
    return std::span(gains_).subspan(slot * std::size_t(gains_each_), std::size_t(gains_each_));
  }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::span<float> row(int slot) {
    return std::span(gains_).subspan(std::size_t(slot) * std::size_t(gains_each_), std::size_t(gains_each_));
  }

  int gains_each_;
  std::vector<Pulse> pulses_;  // by slot
  std::vector<float> gains_;   // by slot
  std::vector<int> active_, free_;
  std::uint64_t dropped_ = 0;
};

}  // namespace intaglio::sound
