// How stiff a surface of some material feels under a tip, as far as the device can show it.
//
// A tip of radius a pressed into a half space of E* = E / (1 - nu^2) is a spring of 2 a E* (flat punch,
// Sneddon 1965), in series with the stiffest spring that is displayed. Stone, glass and wood are a thousand
// times stiffer than any device and feel alike; foam and rubber do not. Pure; N/m.
#pragma once

#include "intaglio/core/material.h"

namespace intaglio::haptics {

inline double punch_stiffness(const Material& material, double tip_radius) {
  return 2 * tip_radius * material.youngs_modulus / (1 - material.poisson_ratio * material.poisson_ratio);
}

inline double felt_stiffness(const Material& material, double tip_radius, double displayed) {
  if (!(tip_radius > 0)) return displayed;  // no tip, no indentation to speak of
  const double punch = punch_stiffness(material, tip_radius);
  return displayed * punch / (displayed + punch);
}

}  // namespace intaglio::haptics
