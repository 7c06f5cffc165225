// The header of an OpenEXR file, read and bounded before OpenEXR sees the file, because OpenEXR allocates
// what a header asks for before it looks whether the file has it. Source: "OpenEXR File Layout", openexr.com.
// Internal to surface/.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "surface/image/image_file.h"

namespace intaglio::surface {

enum class ExrSample { whole_number = 0, half = 1, single = 2 };  // as numbered in files

struct ExrChannel {
  std::string name;
  ExrSample sample;
};

struct ExrHeader {
  int left = 0, top = 0;  // the data window's first pixel; may be negative
  int width = 0, height = 0;
  std::vector<ExrChannel> channels;
  std::size_t channels_at = 0;  // the byte where their list is
  // The header's bytes as OpenEXR shall see them: attributes that do not bear on the pixels (previews,
  // manifests, lists of strings) are given an unknown type, so that it skips them instead of allocating what
  // they claim.
  std::vector<std::uint8_t> shown;
};

// Errors: not a flat single-part image; sizes beyond the limits; attributes that are missing, twice, or of
// the wrong size; blocks of pixels larger than 128 MiB; more blocks than the file has room for.
Result<ExrHeader> read_exr_header(Bytes bytes, const std::string& name, const ImageLimits& limits);

}  // namespace intaglio::surface
