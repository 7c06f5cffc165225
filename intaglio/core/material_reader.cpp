#include "intaglio/core/material_reader.h"

#include <cmath>
#include <filesystem>

#include "intaglio/core/file.h"

namespace intaglio {

namespace {

void read_micro(TomlReader& r, MicroRoughness& micro) {
  r.number("rms_height", micro.rms_height, {0, 1e-2, false, "a height must be between 0 m and 0.01 m"});
  r.number("correlation_length", micro.correlation_length,
           {0, 1, true, "it must be greater than 0 m, at most 1 m"});
  r.number("spectral_slope", micro.spectral_slope,
           {-6, 0, false, "a spectral slope must be between -6 and 0"});
}

void read_overrides(TomlReader& r, Material& m) {
  r.number("density", m.density,
           {1, 1e5, false, "a density must be between 1 and 100000 kg/m^3 (aerogel to beyond osmium)"});
  r.number("youngs_modulus", m.youngs_modulus,
           {1e3, 1e13, false, "a Young's modulus must be between 1e3 and 1e13 Pa (jelly to beyond diamond)"});
  r.number("poisson_ratio", m.poisson_ratio,
           {-0.9, 0.49, false, "a Poisson ratio must be between -0.9 and 0.49"});
  r.number("rayleigh_alpha", m.rayleigh_alpha, {0, 1e6, false, "alpha must be between 0 and 1e6 1/s"});
  r.number("rayleigh_beta", m.rayleigh_beta, {0, 1, false, "beta must be between 0 and 1 s"});
  r.number("friction", m.friction, {0, 10, false, "friction must be between 0 and 10"});
  r.number("restitution", m.restitution, {0, 1, false, "restitution must be between 0 and 1"});
  r.number("rolling_resistance", m.rolling_resistance,
           {0, 1, false, "rolling resistance must be between 0 and 1"});
  r.table("micro", [&](TomlReader& t) { read_micro(t, m.micro); });
  // Outside of it no element is small enough, or nothing rings that can be heard.
  const double speed = std::sqrt(m.youngs_modulus / m.density);
  if (speed < 10 || speed > 50'000)
    r.fail_at(r.has("youngs_modulus") ? "youngs_modulus" : "density",
              fmt::format("sound would be {:.3g} m/s fast in it", speed),
              "the square root of youngs_modulus over density must be between 10 and 50000 m/s (rubber 30, "
              "steel 5000, diamond 18000)");
  if (m.rayleigh_alpha == 0 && m.rayleigh_beta == 0)
    r.fail_at(r.has("rayleigh_alpha") ? "rayleigh_alpha" : "rayleigh_beta", "it would ring for ever",
              "rayleigh_alpha or rayleigh_beta must be greater than 0");
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

Result<Material> parse_material(std::string_view text, const std::string& file_name) {
  const auto table = parse_toml(text, file_name);
  if (!table) return tl::unexpected(table.error());
  std::optional<Error> error;
  TomlReader reader(*table, file_name, "", error);
  Material material;
  material.name = std::filesystem::path(file_name).stem().string();
  reader.text("name", material.name);
  if (auto known = find_material(material.name); known && reader.has("name")) {
    material = *known;
  } else {
    for (const char* key :
         {"density", "youngs_modulus", "poisson_ratio", "rayleigh_alpha", "rayleigh_beta"}) {
      if (!error && !reader.has(key))
        return fail(
            file_name, fmt::format("{} is missing", key),
            "a material needs density, youngs_modulus, poisson_ratio, rayleigh_alpha and rayleigh_beta "
            "in SI units, or the name of a built-in one");
    }
  }
  read_overrides(reader, material);
  reader.finish();
  if (error) return tl::unexpected(*error);
  return material;
}

Result<Material> named_material(const std::string& name_or_file) {
  if (!name_or_file.ends_with(".toml")) return find_material(name_or_file);
  const auto bytes = read_file(name_or_file, 1u << 20);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_material({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, name_or_file);
}

}  // namespace intaglio
