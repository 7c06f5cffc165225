// How large elements may be for the modes that are wanted.
#pragma once

#include "intaglio/core/material.h"
#include "intaglio/sound/fem/modes.h"

namespace intaglio::sound {

// A quarter of the shortest shear wave among them, metres, which leaves the last of 100 modes of a ball 0.4 %
// sharp at most and 0.1 % in the mean; of a thin body (thickness 2 V / A) a fifth of the shortest bending
// wave, if that is less. The shear wave is that at the highest frequency, or of the last of `count` modes of
// a solid by Weyl's law; the bending wave no shorter than the last of `count` modes of a plate has it: one
// mode takes an area of wavelength^2 / pi. Sources: Cremer, Heckl & Petersson, "Structure-Borne Sound", 2005;
// Dupuis, Mazo & Onsager, "Surface specific heat of an isotropic solid at low temperatures", 1960 (Weyl's law
// with the free surface).
double element_size(double volume, double area, const Material& material, const ModeOptions& modes);

}  // namespace intaglio::sound
