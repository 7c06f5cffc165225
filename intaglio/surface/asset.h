// A surface as files of its own: what `intaglio import` writes and `--surface` reads back.
#pragma once

#include <filesystem>

#include "intaglio/surface/import.h"

namespace intaglio::surface {

// Writes `folder`/relief.png (16-bit RGBA: normals +Y in RGB, depth in alpha, 0 = top; RGB where there is no
// depth) and `folder`/color.png. Reading it back detects the same conventions and the same full depth.
Result<void> write_asset(const Imported& imported, const std::filesystem::path& folder);

}  // namespace intaglio::surface
