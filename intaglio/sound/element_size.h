// How large elements may be for the modes that are wanted.
#pragma once

#include "intaglio/core/material.h"
#include "intaglio/sound/fem/modes.h"

namespace intaglio::sound {

// A fifth of the shortest wave among them, metres. That is the shear wave at the highest frequency, or of a
// thin body (thickness 2 V / A) the bending wave, but no shorter than the last of `count` modes of a plate
// has it: one mode takes an area of wavelength^2 / pi; nor than the last of a solid by Weyl's law. Source:
// Cremer, Heckl & Petersson, "Structure-Borne Sound", 2005.
double element_size(double volume, double area, const Material& material, const ModeOptions& modes);

}  // namespace intaglio::sound
