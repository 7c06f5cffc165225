// Any bytes as an image file: an image or one clear error, never a crash, a leak or a huge allocation.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "intaglio/surface/image_file.h"

// The declared size of an image is bounded by the limits of image_file.h, but 64 Mpx is too slow to fuzz
// with: skip what declares more than 1 Mpx. PNG keeps its size in bytes 16 to 23.
static bool too_slow(const std::uint8_t* data, std::size_t size) {
  if (size < 24 || data[0] != 0x89) return false;
  const auto number = [&](int at) {
    return std::uint64_t{data[at]} << 24 | std::uint64_t{data[at + 1]} << 16 |
           std::uint64_t{data[at + 2]} << 8 | data[at + 3];
  };
  return number(16) * number(20) > (1u << 20);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (too_slow(data, size)) return 0;
  const auto image = intaglio::surface::decode_image({data, size}, "fuzz");
  if (!image && image.error().message().find('\n') != std::string::npos) std::abort();
  return 0;
}
