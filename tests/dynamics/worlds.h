// Gravity, a material, options and the size of gratings, shared by tests of worlds.
#pragma once

#include "dynamics/world.h"
#include "intaglio/representation.h"

namespace intaglio::tests {

inline constexpr double g = 9.81;                                     // m/s^2
inline constexpr double grating_period = 0.08, grating_depth = 0.02;  // m

// Light, without rolling resistance, which would hide errors of momentum and energy.
inline Material light_material(double friction, double restitution = 0) {
  Material out;
  out.name = "test";
  out.density = 600;
  out.friction = friction;
  out.restitution = restitution;
  out.rolling_resistance = 0;
  return out;
}

inline dynamics::WorldOptions options_for(Representation representation) {
  dynamics::WorldOptions options;
  options.representation = representation;
  return options;
}

}  // namespace intaglio::tests
