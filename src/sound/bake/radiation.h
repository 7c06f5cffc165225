// How loud a vibrating body is: the pressure that its surface radiates, far away.
//
// Kirchhoff's integral over the surface, p = (i k / 4 pi r) sum of A e^(i k e.x) (rho c u + e.n p_s), with
// the normal velocity u of the surface and the pressure p_s on it, root mean square over all directions e.
// The integral decides what cancels, so below k a = 1 every order falls by its own (k a): a body that
// breathes is a monopole, one that shakes a dipole; a free body's bending modes are of higher order, since
// each displaces no volume and gives no momentum. p_s is that of incompressible air (near_field.h), i omega
// rho Phi, turning into rho c u where the wave number exceeds that of the shape. With the length
// s = <u, Phi> / <u, u> (a / (n + 1) for order n of a sphere, 1 / k_p of a plane wave of wave number k_p),
// x = k s and eta = (s / a)^(2/3), a that of a sphere of as much surface,
//
//   p_s = rho c (Re z u + i Im z / s Phi),   z = x / sqrt(x^2 - 1 - 2 i eta x):
//
// exact for a sphere that breathes (eta = 1) and for a wave without end (eta = 0); the power 2/3 is that of
// the width of the transition of high orders, Airy's. Above x = 1.4 the power is rho c Re z u^2. Against
// closed forms: orders 0 to 3 of a sphere within 1.5 dB at any k a, a shaking disk within 1, a plate that
// bends within 1.6 from a fifth above coincidence. Orders that fall below a thirtieth of a dipole of the
// same velocity are as uncertain as the mesh is uneven. No directivity, no room, no other bodies.
//
// Modes of one frequency sound as one, and their shapes are known only up to a rotation of each other. So
// what is heard of them must be one linear function of the shape: their weights are in proportion to the
// pressure in one fixed direction of the body, and as large together as their root mean squares over all
// directions. A mode that is alone keeps its root mean square; only the sign is the direction's. `kinship`
// says which modes are one. Sources: Fahy & Gardonio, "Sound and Structural Vibration", 2007, ch. 3; Cremer,
// Heckl, Petersson, "Structure-Borne Sound", 2005, ch. 6; Morse & Ingard, "Theoretical Acoustics", ch. 7;
// O'Brien, Shen, Gatchalian, "Synthesizing sounds from rigid-body simulations", 2002.
#pragma once

#include <span>
#include <vector>

#include "intaglio/vec.h"
#include "sound/modal_model.h"

namespace intaglio::sound {

// A surface that moves: triangles outward and, but for open sheets with both sides, closed.
struct VibratingSurface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  Eigen::MatrixXd velocity;  // m/s, outward normal: a row for each triangle, a column for each vibration
};

// Pa at 1 m of each vibration, at its angular frequency: amplitude for amplitude, so that a velocity in rms
// gives a pressure in rms. A rotation among vibrations whose kinship is 1 leaves the sum over them, each
// times its pressure, unchanged. Some 100 to 500 sines a triangle and vibration, and one near_potential().
std::vector<double> radiated_pressure(const VibratingSurface& surface, std::span<const double> omega,
                                      const Eigen::MatrixXd& kin);
// Of vibrations of which none is another's kin: positive.
std::vector<double> radiated_pressure(const VibratingSurface& surface, std::span<const double> omega);

// m^3/s through a model's surface, of each mode.
Eigen::RowVectorXd volume_velocity(const ModalModel& model);

// The pressure of a model's modes, for a modal velocity of 1, with its sign. Large surfaces are sampled more
// coarsely for it, but displace what `volume` says, which is known best from the surface before it was
// sampled. `thickness`: of a shell whose model has one side only, m; 0: the surface is a body's. About 1 s.
std::vector<double> radiation_of(const ModalModel& model, const Eigen::RowVectorXd& volume,
                                 double thickness = 0);

}  // namespace intaglio::sound
