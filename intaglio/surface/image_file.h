// Image files: PNG (1 to 16 bits a sample) and JPEG, decoded from memory, with limits on what untrusted files may ask for.
// Errors name the file and, where the decoder knows it, what is broken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "intaglio/core/error.h"
#include "intaglio/core/image.h"

namespace intaglio::surface {

inline constexpr std::uint32_t max_side = 16384;
inline constexpr std::uint64_t max_pixels = 64ull << 20;

struct DecodedImage {
  Image<float> pixels;  // 1 (grey), 3 (RGB) or 4 (RGBA) channels, 0..1; row 0 = top
  int bit_depth = 8;  // of the file
};

Result<DecodedImage> decode_image(std::span<const std::uint8_t> bytes, const std::string& name);
Result<DecodedImage> read_image(const std::filesystem::path& path);

}  // namespace intaglio::surface
