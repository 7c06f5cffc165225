// How loud a vibrating body is: the pressure that its surface radiates into the far field.
//
// Kirchhoff's integral over the surface,
//
//   p = (i k / 4 pi r) sum of A e^(i k e.x) (rho c u + e.n p_s),
//
// with the surface's normal velocity u and pressure p_s, as root mean square over all directions e.
// Cancellation follows from the integral, so below k a = 1 every order falls by its own power of k a: a
// pulsating body is a monopole, an oscillating one a dipole; a free body's bending modes are of higher order,
// since each displaces no volume and carries no momentum. With the potential Phi of incompressible air
// (near_field.h) and
//
//   s = <u, Phi> / <u, u>      a / (n + 1) for order n of a sphere, 1 / k_p for a plane wave of number k_p
//   x = k s                    above 1 the wave is faster than sound
//   eta = (s / a)^(2/3)        a: radius of the sphere of equal area
//   z = x / sqrt(x^2 - 1 - 2 i eta x),
//
// the surface pressure is p_s = rho c (Re z u + i Im z / s Phi), which is derived in radiation.cpp. Above
// x = 1.4 the radiated power is rho c Re z u^2. Against closed forms: orders 0 to 3 of a sphere within 1.5 dB
// at any k a, an oscillating disk within 1, a bending plate within 1.6 from a fifth above coincidence. Orders
// that fall below a thirtieth of a dipole of the same velocity are as uncertain as the mesh is uneven. No
// directivity, no room, no other bodies.
//
// Modes of equal frequency are heard as one, and their shapes are defined only up to a rotation. So their
// weights must be one linear functional of the shape: they are proportional to the pressure in one fixed
// direction of the body, scaled so that their total equals the sum of their mean squares over all directions.
// A mode that is alone keeps its root mean square; only the sign is the direction's. coherence() tells which
// modes are heard as one. Sources: Fahy & Gardonio, "Sound and Structural Vibration", 2007, ch. 3; Cremer,
// Heckl, Petersson, "Structure-Borne Sound", 2005, ch. 6; Morse & Ingard, "Theoretical Acoustics", ch. 7;
// O'Brien, Shen, Gatchalian, "Synthesizing sounds from rigid-body simulations", 2002.
#pragma once

#include <span>
#include <vector>

#include "intaglio/vec.h"
#include "sound/modal_model.h"

namespace intaglio::sound {

// A vibrating surface: triangles face outwards and, except for open sheets with both sides, it is closed.
struct VibratingSurface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  Eigen::MatrixXd velocity;  // m/s, along the outward normal: a row per triangle, a column per vibration
};

// Pa at 1 m of each vibration, at its angular frequency: amplitude for amplitude, so that a velocity in rms
// gives a pressure in rms. A rotation among vibrations whose coherence is 1 leaves unchanged the sum over
// them, each times its pressure. Cost: 100 to 500 sines per triangle and vibration, and one
// incompressible_potential().
std::vector<double> radiated_pressure(const VibratingSurface& surface, std::span<const double> omega,
                                      const Eigen::MatrixXd& coherence);
// The same for vibrations of which no two are coherent; positive.
std::vector<double> radiated_pressure(const VibratingSurface& surface, std::span<const double> omega);

// m^3/s through a model's surface, of each mode.
Eigen::RowVectorXd volume_velocity(const ModalModel& model);

// The pressure of a model's modes, for a modal velocity of 1, with sign. Large surfaces are sampled more
// coarsely for it, but keep their displaced `volume`, which is known best from the surface before it was
// sampled. `thickness`: m, of a shell modelled by one sheet; 0: the surface is a body's. About 1 s.
std::vector<double> mode_radiation(const ModalModel& model, const Eigen::RowVectorXd& volume,
                                   double thickness = 0);

}  // namespace intaglio::sound
