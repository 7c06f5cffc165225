// Modal models as files: what `intaglio bake` writes and the synthesizer plays.
//
// FlatBuffers by the schema model.fbs, little-endian on every machine. Files are not trusted: the verifier
// checks their structure, the reader that lengths agree, indices exist, numbers are finite and modes ascend
// and ring; a model without a mode is an error. Only format version 3 is read. Limit 256 MB. Most of the cost
// of reading is building the grid over the surface (triangle_grid.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "sound/modal_model.h"

namespace intaglio::sound {

std::vector<std::uint8_t> model_bytes(const ModalModel& model);

// `name` appears in errors.
Result<ModalModel> parse_model(std::span<const std::uint8_t> bytes, const std::string& name);

// Atomic. Fails for a model without a mode.
Result<void> write_model(const std::filesystem::path& path, const ModalModel& model);
Result<ModalModel> read_model(const std::filesystem::path& path);

}  // namespace intaglio::sound
