// Modal models as files: what `intaglio bake` writes and sound reads.
//
// FlatBuffers by the schema model.fbs, little-endian on every machine. Files are not trusted: the verifier
// checks their structure, the reader that lengths agree, indices exist, numbers are finite and modes ascend
// and ring; a model without a mode is an error. A file of another format version is refused: version 2 knows
// how much of each mode the air takes (radiation.h). Limit 256 MB. Most of the cost of reading is the grid
// over the surface (triangle_grid.h).
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "intaglio/error.h"
#include "sound/modal_model.h"

namespace intaglio::sound {

std::vector<std::uint8_t> model_bytes(const ModalModel& model);

// `name` is for errors.
Result<ModalModel> parse_model(std::span<const std::uint8_t> bytes, const std::string& name);

// Written whole or not at all. A model without a mode is refused.
Result<void> write_model(const std::filesystem::path& path, const ModalModel& model);
Result<ModalModel> read_model(const std::filesystem::path& path);

}  // namespace intaglio::sound
