// A body as its modes: all that sound needs to know of it.
//
// Immutable once baked, shared by any number of sounding bodies, safe to ask from any thread. Mode m has
// angular frequency omega, damping d = (alpha + beta omega^2) / 2, and rings as e^(-d t) sin(omega_d t),
// omega_d^2 = omega^2 - d^2, so that T60 = ln(1000) / d. Shapes are mass-normalised (kg^-1/2): an impulse j
// (N s) at a point adds phi . j to the modal velocity. Positions are in the body's own frame, metres. Source:
// paper §1.2.5 and §1.4; Shabana, "Theory of Vibration".
#pragma once

#include <span>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/material.h"
#include "sound/triangle_grid.h"

namespace intaglio::sound {

struct ModalModel {
  std::string name;
  std::string source;  // its identity: the hash of what it was baked from and how (bake_inputs), or empty
  Material material;
  double mass = 0;      // kg
  double area = 0;      // m^2, of the surface
  double residual = 0;  // the worst |K u - lambda M u| / (lambda |M u|) of its modes

  std::vector<double> angular_frequency;  // omega, rad/s, ascending
  std::vector<double> damping;            // d, 1/s; always below omega
  std::vector<double> radiation;          // Pa at 1 m for a modal velocity of 1, with sign (radiation.h)

  std::vector<Vec3> points;         // of the surface, as many as sound needs
  std::vector<Triangle> triangles;  // outward
  std::vector<float>
      shapes;  // point by point: x of every mode, then y, then z; baked ones of 16 bits (round_shapes)
  TriangleGrid grid;
  // Of shapes between the points, linear over the triangles, against those of the elements: root mean square
  // over the surface, relative, of the worst mode.
  double shape_error = 0;
  // Of merging (merge_modes.h): how many modes there were, 0 if none were merged, and what it changed, dB.
  int modes_found = 0;
  double merge_error_db = 0, merge_error_rms_db = 0;

  int modes() const { return static_cast<int>(angular_frequency.size()); }
  Vec3 shape(int point, int mode) const;

  // out[m] = phi_m . direction at the surface point nearest to `point_local`, for the first out.size() modes.
  // Real-time: no allocation; one TriangleGrid query and nine multiplications a mode, about 1 microsecond for
  // 100 modes.
  void gains(const Vec3& point_local, const Vec3& direction_local, std::span<float> out) const;
};

// Shapes are kept in 16 bits: as multiples of a unit for each mode, the power of two by which its largest
// value fits, so within a 32,767th of it (90 dB below). round_shapes() rounds a model's to that, so that a
// model read is the model that was written; again it changes nothing.
void round_shapes(ModalModel& model);
std::vector<float> shape_units(const ModalModel& model);
std::vector<std::int16_t> rounded_shapes(const ModalModel& model, std::span<const float> units);

// Air at 20 degrees Celsius.

inline constexpr double air_density = 1.204;     // kg/m^3
inline constexpr double speed_of_sound = 343.2;  // m/s

// How far two vibrations sound as one, a row and a column for each: 1 where they beat so slowly that they
// have died away long before, falling to 0 where they differ by more than a fiftieth of their decay rate
// (1/s).
Eigen::MatrixXd kinship(std::span<const double> omega, std::span<const double> damping);

// What a mode of that damping (1/s) gives away when air takes all that it loses: Pa at 1 m for a modal
// velocity of 1. Power 4 pi p^2 / (2 rho c) is at most 2 d times the energy 1/2. The material's damping is
// that of the body in air, so no mode that is alone is louder.
double most_radiated(double damping);

// Of each mode, how loud it and its kin are together for what most_radiated() allows them together. A single
// combination of n kin is all that sounds of them (it is what one direction hears), and may reach sqrt(n).
std::vector<double> radiated_share(const ModalModel& model);
// Turns modes down to a share of 1, or to what each had before, if that was more.
void limit_radiation(ModalModel& model, std::span<const double> before = {});

// The same body larger or smaller, without baking it again.
//
// When all lengths grow by s, frequencies go as 1 / s, mass as s^3, mass-normalised shapes as s^(-3/2),
// surface as s^2; damping follows from the material at the new frequency (Rayleigh), and radiation from size
// and frequency. The mesh turns with it exactly: this is what baking the scaled mesh gives, but for
// near-equal modes of damped materials: which of them sound as one (radiation.h) is kept as it was. Modes
// that no longer ring (overdamped) are left out. Milliseconds: it copies the model and makes its grid anew.
// Any thread.

// `scale` > 0.
ModalModel scaled(const ModalModel& model, double scale);

}  // namespace intaglio::sound
