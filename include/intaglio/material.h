// What a body is made of: one record that dynamics, haptics and sound all read.
//
// Elastic constants and Rayleigh damping: damping matrix C = alpha M + beta K, so a mode of angular frequency
// w decays at d = (alpha + beta w^2) / 2. Some published code swaps the two names. Values: docs/materials.md.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "intaglio/error.h"

namespace intaglio {

// Surface detail too fine for any texture: a fractal height with a spectral power law.
struct MicroRoughness {
  double rms_height = 1e-5;          // m
  double correlation_length = 1e-4;  // m
  double spectral_slope = -2.2;      // exponent of the power spectral density above 1 / correlation length
};

struct Material {
  std::string name;
  double density = 1000;        // kg/m^3
  double youngs_modulus = 1e9;  // Pa
  double poisson_ratio = 0.3;   // in (-1, 0.5)
  double rayleigh_alpha = 10;   // 1/s
  double rayleigh_beta = 1e-6;  // s
  double friction = 0.5;        // Coulomb, of a pair: the product of both, square-rooted
  double restitution = 0.3;     // in [0, 1], of a pair: the product of both
  // Resisting moment over (normal force x radius), of a pair: the sum of both.
  double rolling_resistance = 0.005;
  MicroRoughness micro;

  double shear_modulus() const { return youngs_modulus / (2.0 * (1.0 + poisson_ratio)); }
};

// The built-in materials: ceramic, glass, wood, plastic, iron, polycarbonate, steel, brick, stone.
std::span<const Material> materials();

// The built-in material of that name, or an error that lists the names and the nearest one.
Result<Material> find_material(std::string_view name);

// What options take for a material: the name of a built-in one, or your own values.
class MaterialChoice {
 public:
  MaterialChoice(const char* name) : name_(name) {}
  MaterialChoice(std::string name) : name_(std::move(name)) {}
  MaterialChoice(const Material& values) : values_(values) {}

  // Errors: those of find_material.
  Result<Material> material() const {
    return values_ ? Result<Material>(*values_) : find_material(name_);
  }

 private:
  std::string name_;
  std::optional<Material> values_;
};

}  // namespace intaglio
