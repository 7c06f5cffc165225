// A body as its modes: everything the synthesizer needs.
//
// Immutable once baked, shared by any number of sounding bodies, safe to query from any thread. Mode m has
// angular frequency omega, damping d = (alpha + beta omega^2) / 2, and rings as e^(-d t) sin(omega_d t),
// omega_d^2 = omega^2 - d^2, so that T60 = ln(1000) / d. Shapes are mass-normalised (kg^-1/2): an impulse j
// (N s) at a point adds phi . j to the modal velocity. Positions are in the body's own frame, metres. Source:
// paper §1.2.5 and §1.4; Shabana, "Theory of Vibration".
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "intaglio/material.h"
#include "intaglio/vec.h"
#include "sound/triangle_grid.h"

namespace intaglio::sound {

struct ModalModel {
  std::string name;
  std::string identity;  // hash of what it was baked from and how (bake_hash), or empty
  Material material;
  double mass = 0;      // kg
  double area = 0;      // m^2, of the surface
  double residual = 0;  // the worst |K u - lambda M u| / (lambda |M u|) of its modes

  std::vector<double> angular_frequency;  // omega, rad/s, ascending
  std::vector<double> damping;            // d, 1/s; always below omega
  std::vector<double> radiation;          // Pa at 1 m for a modal velocity of 1, with sign (bake/radiation.h)

  std::vector<Vec3> points;         // surface points
  std::vector<Triangle> triangles;  // outward
  // Point by point: x of every mode, then y, then z. Those of a baked model have 16 bits (quantise_shapes).
  std::vector<float> shapes;
  TriangleGrid grid;
  // RMS error over the surface of shapes interpolated linearly over the triangles against those of the
  // elements, relative, of the worst mode.
  double shape_error = 0;
  // Results of merging (bake/merge_modes.h): how many modes there were, 0 if none were merged, and what it
  // changed, dB.
  int modes_before_merging = 0;
  double merge_error_db = 0, merge_error_rms_db = 0;

  int modes() const { return int(angular_frequency.size()); }
  Vec3 shape(int point, int mode) const;

  // out[m] = phi_m . direction at the surface point nearest to `point_local`, for the first out.size() modes.
  // Real-time: no allocation; one TriangleGrid query and nine multiplications per mode, about 1 microsecond
  // for 100 modes.
  void gains(const Vec3& point_local, const Vec3& direction_local, std::span<float> out) const;
};

// d of a mode (1/s), from the material's Rayleigh damping.
inline double rayleigh_damping(const Material& material, double omega) {
  return 0.5 * (material.rayleigh_alpha + material.rayleigh_beta * omega * omega);
}

// Shapes are stored in 16 bits, in units of a power of two per mode, the smallest in which its largest value
// fits: an error below a 32,767th of that value (90 dB). quantise_shapes() rounds a model's shapes to that,
// so that a model read is the model that was written; repeating it changes nothing.
void quantise_shapes(ModalModel& model);
std::vector<float> shape_scales(const ModalModel& model);
std::vector<std::int16_t> quantised_shapes(const ModalModel& model, std::span<const float> scales);

// Air at 20 degrees Celsius.

inline constexpr double air_density = 1.204;     // kg/m^3
inline constexpr double speed_of_sound = 343.2;  // m/s

// How coherently two vibrations sound, a row and a column for each: 1 if they beat so slowly that they have
// died away long before a beat, falling to 0 where they differ by more than a fiftieth of their decay rate
// (1/s).
Eigen::MatrixXd coherence(std::span<const double> omega, std::span<const double> damping);

// Radiation of a mode whose entire damping (1/s) is radiation, Pa at 1 m for a modal velocity of 1: the upper
// limit, since a material's damping is that of the body in air. A modal velocity of amplitude 1 has the
// energy 1/2 and loses 2 d / 2 = d per second; radiated is 4 pi p^2 / (2 rho c). So p^2 <= rho c d / (2 pi).
double max_radiation(double damping);

// For each mode, the radiation of its coherent group over the group's limit. Only one combination of n
// coherent modes sounds (the one that one direction hears), and it may reach sqrt(n).
std::vector<double> radiation_over_limit(const ModalModel& model);
// Scales modes down to a ratio of at most 1, or of `before[m]`, if that is larger.
void limit_radiation(ModalModel& model, std::span<const double> before = {});

// The same body larger or smaller, without baking it again.
//
// When all lengths scale by s, frequencies scale as 1 / s, mass as s^3, mass-normalised shapes as s^(-3/2),
// area as s^2; damping follows from the material at the new frequency (Rayleigh), and radiation from size and
// frequency. This is what baking the scaled mesh gives, except for near-equal modes of damped materials:
// which of them are coherent stays as it was. Overdamped modes are left out. Milliseconds: it copies the
// model and rebuilds its grid. Any thread.

// `scale` > 0.
ModalModel scaled(const ModalModel& model, double scale);

}  // namespace intaglio::sound
