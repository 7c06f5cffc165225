// Any bytes as an image file of one format: an image or one clear error, never a crash, a leak or a huge
// allocation. Built once for each decoder, which DECODE names.
#include <cmath>

#include "fuzz/require.h"
#include "surface/image/image_file.h"

using namespace intaglio;
using namespace intaglio::surface;
using fuzz::require;

// The limits for users are too slow for fuzzing.
constexpr ImageLimits limits{2048, 1u << 18};

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto image = DECODE({data, size}, "fuzz", limits);
  if (!image) {
    fuzz::require_clear(image.error(), "fuzz: ");
    return 0;
  }
  const auto& pixels = image->pixels;
  require(pixels.width > 0 && pixels.height > 0 &&
          std::uint64_t(pixels.width) * std::uint64_t(pixels.height) <= limits.pixels);
  require(pixels.channels == 1 || pixels.channels == 3 || pixels.channels == 4);
  require(image->bit_depth == 8 || image->bit_depth == 16 || image->bit_depth == 32);
  for (const float value : pixels.data) require(std::isfinite(value));
  return 0;
}
