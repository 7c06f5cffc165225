#include "intaglio/core/material_reader.h"

namespace intaglio {

namespace {

constexpr double most = 1e15;

void read_micro(TomlReader& r, MicroRoughness& micro) {
  r.number("rms_height", micro.rms_height, {0, 1e-2, false, "a height must be between 0 m and 0.01 m"});
  r.number("correlation_length", micro.correlation_length,
           {0, 1, true, "it must be greater than 0 m, at most 1 m"});
  r.number("spectral_slope", micro.spectral_slope,
           {-6, 0, false, "a spectral slope must be between -6 and 0"});
}

void read_overrides(TomlReader& r, Material& m) {
  r.number("density", m.density, {0, 1e6, true, "a density must be greater than 0 kg/m^3"});
  r.number("youngs_modulus", m.youngs_modulus,
           {0, most, true, "a Young's modulus must be greater than 0 Pa"});
  r.number("poisson_ratio", m.poisson_ratio,
           {-0.9, 0.49, false, "a Poisson ratio must be between -0.9 and 0.49"});
  r.number("rayleigh_alpha", m.rayleigh_alpha, {0, most, false, "alpha must be at least 0 1/s"});
  r.number("rayleigh_beta", m.rayleigh_beta, {0, most, false, "beta must be at least 0 s"});
  r.number("friction", m.friction, {0, 10, false, "friction must be between 0 and 10"});
  r.number("restitution", m.restitution, {0, 1, false, "restitution must be between 0 and 1"});
  r.number("rolling_resistance", m.rolling_resistance,
           {0, 1, false, "rolling resistance must be between 0 and 1"});
  r.table("micro", [&](TomlReader& t) { read_micro(t, m.micro); });
}

}  // namespace

void read_material(TomlReader& reader, const char* key, Material& material) {
  const auto start_from = [&](TomlReader& at, const char* name_key) {
    std::string name = material.name;
    at.text(name_key, name);
    if (name == material.name) return;
    const auto found = find_material(name);
    if (found) {
      material = *found;
    } else {
      at.fail_at(name_key, found.error().what, found.error().fix);
    }
  };
  if (!reader.is_table(key)) return start_from(reader, key);
  reader.table(key, [&](TomlReader& t) {
    start_from(t, "name");
    read_overrides(t, material);
  });
}

}  // namespace intaglio
