// The click of a body that is struck: its sudden acceleration as a whole pushes the air, before and beside
// its ringing.
//
// Pure. A body of surface `area` is taken as a sphere of that area, radius a. The far-field pressure of a
// sphere that accelerates (a dipole of finite ka) is its acceleration through a damped resonance,
//   p(s) / A(s) = rho c a cos(angle) s / ((s + c/a)^2 + (c/a)^2)   at 1 m,
// which is one more resonator of a modal bank: undamped angular frequency sqrt(2) c/a, damping c/a, modal
// velocity the body's own, radiation rho c a. An impulse J moves it by J / mass. cos(angle) is taken as its
// root mean square over all directions, 1 / sqrt(3). Source: Morse & Ingard, "Theoretical Acoustics", §7.2;
// Chadwick, Zheng, James, "Precomputed acceleration noise for improved rigid-body sound", 2012.
#pragma once

#include "intaglio/sound/modal_bank.h"

namespace intaglio::sound {

Resonator acceleration_noise(double area);
// What a unit impulse gives it: 1 / (sqrt(3) mass).
double acceleration_gain(double mass);

}  // namespace intaglio::sound
