// Any bytes as an image file of one format: an image or one clear error, never a crash, a leak or a huge
// allocation. Built once for each decoder, which DECODE names.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "surface/image/image_file.h"

using namespace intaglio::surface;

// The limits for users are too slow for fuzzing.
constexpr ImageLimits limits{2048, 1u << 18};

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto image = DECODE({data, size}, "fuzz", limits);
  if (!image) {
    const std::string message = image.error().message();
    require(message.find("fuzz: ") == 0 && message.find_first_of("\n\r") == std::string::npos);
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
