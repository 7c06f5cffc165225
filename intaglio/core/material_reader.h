// A material in a TOML file: a built-in name, or a table that overrides parts of one.
//   material = "steel"     or     material = { name = "steel", rayleigh_alpha = 20, micro = { rms_height =
//   1e-6 } }
#pragma once

#include "intaglio/core/material.h"
#include "intaglio/core/toml_reader.h"

namespace intaglio {

// Reads `key` into `material`, which holds the default.
void read_material(TomlReader& reader, const char* key, Material& material);

}  // namespace intaglio
