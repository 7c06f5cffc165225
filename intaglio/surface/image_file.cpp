#include "intaglio/surface/image_file.h"

#include <spng.h>
#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "intaglio/core/file.h"

namespace intaglio::surface {

namespace {

constexpr std::array<std::uint8_t, 8> png_signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

Result<void> check_size(const std::string& name, std::uint64_t width, std::uint64_t height) {
  if (width == 0 || height == 0) return fail(name, fmt::format("is {} x {} pixels", width, height), "an image has at least one");
  if (width > max_side || height > max_side || width * height > max_pixels) {
    return fail(name, fmt::format("is {} x {} pixels", width, height),
                fmt::format("at most {0} x {0} and {1} Mpx are read", max_side, max_pixels >> 20));
  }
  return {};
}

Image<float> take_channels(const std::vector<std::uint16_t>& rgba, int width, int height, int channels) {
  Image<float> out(width, height, channels);
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  for (std::size_t p = 0; p < pixels; ++p) {
    for (int c = 0; c < channels; ++c) out.data[p * std::size_t(channels) + std::size_t(c)] = static_cast<float>(rgba[p * 4 + std::size_t(c)]) / 65535.0f;
  }
  return out;
}

Result<DecodedImage> decode_png(std::span<const std::uint8_t> bytes, const std::string& name) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(0), spng_ctx_free);
  const auto broken = [&](int status) { return fail(name, fmt::format("is a broken PNG of {} bytes: {}", bytes.size(), spng_strerror(status)), "save it again"); };
  spng_set_image_limits(context.get(), max_side, max_side);
  spng_set_chunk_limits(context.get(), 64u << 20, 128u << 20);
  spng_set_crc_action(context.get(), SPNG_CRC_ERROR, SPNG_CRC_USE);
  spng_set_png_buffer(context.get(), bytes.data(), bytes.size());
  spng_ihdr header{};
  if (const int status = spng_get_ihdr(context.get(), &header); status != 0) {
    if (status == SPNG_EUSER_WIDTH || status == SPNG_EUSER_HEIGHT) return fail(name, "is too large", fmt::format("at most {0} x {0} pixels are read", max_side));
    return broken(status);
  }
  if (auto size = check_size(name, header.width, header.height); !size) return tl::unexpected(size.error());

  std::vector<std::uint16_t> rgba(std::size_t(header.width) * header.height * 4);
  if (const int status = spng_decode_image(context.get(), rgba.data(), rgba.size() * 2, SPNG_FMT_RGBA16, SPNG_DECODE_TRNS); status != 0) {
    return broken(status);
  }
  spng_trns transparency{};
  const bool has_transparency = spng_get_trns(context.get(), &transparency) == 0;
  const bool grey = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE;
  const bool alpha = has_transparency || header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA || header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA;
  const int channels = alpha ? 4 : grey ? 1 : 3;
  return DecodedImage{take_channels(rgba, static_cast<int>(header.width), static_cast<int>(header.height), channels), header.bit_depth};
}

Result<DecodedImage> decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& name) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  const auto broken = [&] { return fail(name, fmt::format("is a broken JPEG of {} bytes: {}", bytes.size(), tjGetErrorStr2(decoder.get())), "save it again"); };
  int width = 0, height = 0, subsampling = 0, colourspace = 0;
  if (tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width, &height, &subsampling, &colourspace) != 0) return broken();
  if (auto size = check_size(name, static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height)); !size) return tl::unexpected(size.error());
  const int channels = colourspace == TJCS_GRAY ? 1 : 3;
  Image8 image(width, height, channels);
  // Decoding fails, rather than warns, on a truncated file: a half-grey texture would be felt as a step.
  if (tjDecompress2(decoder.get(), bytes.data(), bytes.size(), image.data.data(), width, 0, height, channels == 1 ? TJPF_GRAY : TJPF_RGB, TJFLAG_STOPONWARNING) != 0) return broken();
  DecodedImage out{Image<float>(width, height, channels), 8};
  std::transform(image.data.begin(), image.data.end(), out.pixels.data.begin(), [](std::uint8_t v) { return static_cast<float>(v) / 255.0f; });
  return out;
}

}  // namespace

Result<DecodedImage> decode_image(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.empty()) return fail(name, "is an empty file (0 bytes)", "a PNG or JPEG image is needed");
  if (bytes.size() >= png_signature.size() && std::equal(png_signature.begin(), png_signature.end(), bytes.begin())) return decode_png(bytes, name);
  if (bytes.size() >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff) return decode_jpeg(bytes, name);
  return fail(name, "is neither a PNG nor a JPEG (byte 0 does not start one)", "convert it to PNG");
}

Result<DecodedImage> read_image(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return decode_image(*bytes, path.string());
}

}  // namespace intaglio::surface
