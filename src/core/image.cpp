#include "intaglio/image.h"

#include <spng.h>

#include <bit>
#include <cstdlib>
#include <memory>
#include <stdexcept>

namespace intaglio {

namespace {

static_assert(std::endian::native == std::endian::little, "SPNG_FMT_PNG below is given host-endian samples");

spng_color_type color_type(int channels) {
  switch (channels) {
    case 1:
      return SPNG_COLOR_TYPE_GRAYSCALE;
    case 3:
      return SPNG_COLOR_TYPE_TRUECOLOR;
    case 4:
      return SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
    default:
      throw std::invalid_argument("a PNG has 1, 3 or 4 channels");
  }
}

template <class T>
std::vector<std::uint8_t> encode(const Image<T>& image) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free);
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_ihdr header{};
  header.width = std::uint32_t(image.width);
  header.height = std::uint32_t(image.height);
  header.bit_depth = 8 * sizeof(T);
  header.color_type = std::uint8_t(color_type(image.channels));
  spng_set_ihdr(context.get(), &header);
  int status = spng_encode_image(context.get(), image.data.data(), image.data.size() * sizeof(T),
                                 SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  std::size_t size = 0;
  void* buffer = status == 0 ? spng_get_png_buffer(context.get(), &size, &status) : nullptr;
  if (buffer == nullptr)
    throw std::runtime_error(std::string("PNG encoding failed: ") + spng_strerror(status));
  const auto* bytes = static_cast<const std::uint8_t*>(buffer);
  std::vector<std::uint8_t> out(bytes, bytes + size);
  std::free(buffer);
  return out;
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Image8& image) {
  return encode(image);
}
std::vector<std::uint8_t> encode_png(const Image16& image) {
  return encode(image);
}

}  // namespace intaglio
