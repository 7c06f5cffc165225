// A material in a TOML file: a built-in name, or a table that overrides parts of one.
//   material = "steel"     or     material = { name = "steel", rayleigh_alpha = 20, micro = { rms_height =
//   1e-6 } }
#pragma once

#include "intaglio/core/material.h"
#include "intaglio/core/toml_reader.h"

namespace intaglio {

// Reads `key` into `material`, which holds the default.
void read_material(TomlReader& reader, const char* key, Material& material);

// A material as a TOML text of its own: the keys of such a table at the top level. When `name` is not a
// built-in material it must give density, youngs_modulus, poisson_ratio, rayleigh_alpha and rayleigh_beta.
Result<Material> parse_material(std::string_view text, const std::string& file_name);

// What a command line calls a material: a built-in name, or a file whose name ends in .toml.
Result<Material> named_material(const std::string& name_or_file);

}  // namespace intaglio
