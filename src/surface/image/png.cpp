#include <spng.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "surface/image/image_file.h"

namespace intaglio::surface {

namespace {

using Context = std::unique_ptr<spng_ctx, void (*)(spng_ctx*)>;

// The bytes that libspng reads; `at` is how far it has read, reported as the place of an error.
struct Source {
  Bytes bytes;
  std::size_t at = 0;
  // Read past the end: libspng accepts that after the last pixel, we reject it.
  bool hit_end = false;
};

int read_source(spng_ctx*, void* user, void* destination, std::size_t length) {
  Source& source = *static_cast<Source*>(user);
  const bool enough = length <= source.bytes.size() - source.at;
  const std::size_t taken = enough ? length : source.bytes.size() - source.at;
  if (enough && length > 0) std::memcpy(destination, source.bytes.data() + source.at, length);
  source.at += taken;
  source.hit_end = source.hit_end || !enough;
  return enough ? 0 : SPNG_IO_EOF;
}

Context open(Source& source) {
  Context context(spng_ctx_new(0), spng_ctx_free);
  spng_set_chunk_limits(context.get(), 64u << 20, 128u << 20);
  spng_set_crc_action(context.get(), SPNG_CRC_ERROR, SPNG_CRC_ERROR);
  spng_set_png_stream(context.get(), read_source, &source);
  return context;
}

// Deflate packs at most 1032 bytes into one: a smaller file is truncated; reject it before allocating.
bool can_hold(std::size_t file_size, const spng_ihdr& header) {
  constexpr std::array<std::uint64_t, 7> samples{1, 0, 3, 1, 2, 0, 4};  // by colour type
  const std::uint64_t bits = samples.at(header.color_type) * header.bit_depth;
  return std::uint64_t{header.width} * header.height * bits / 8 / 1032 <= file_size;
}

int channels_of(spng_ctx* context, const spng_ihdr& header) {
  spng_trns transparency{};
  const bool alpha = header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
                     header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA ||
                     spng_get_trns(context, &transparency) == 0;
  if (alpha) return 4;
  return header.color_type == SPNG_COLOR_TYPE_GRAYSCALE ? 1 : 3;
}

// The columns of a pass of an interlaced file; the last pass and plain files have all of them.
struct Columns {
  int first, step;
};
constexpr std::array<Columns, 7> adam7{{{0, 8}, {4, 8}, {0, 4}, {2, 4}, {0, 2}, {1, 2}, {0, 1}}};

// Row by row, so that there is never a second copy of a large image. Libspng widens all samples to 16 bits by
// exact integer factors (65535 / (2^bits - 1) is an integer), so the quotients below are those of the file's
// samples, correctly rounded.
int decode_rows(spng_ctx* context, bool interlaced, Image<float>& image) {
  std::vector<std::uint16_t> row(std::size_t(image.width) * 4);
  int status =
      spng_decode_image(context, nullptr, 0, SPNG_FMT_RGBA16, SPNG_DECODE_TRNS | SPNG_DECODE_PROGRESSIVE);
  while (status == 0) {
    spng_row_info place{};
    status = spng_get_row_info(context, &place);
    if (status != 0) break;
    status = spng_decode_row(context, row.data(), row.size() * sizeof(std::uint16_t));
    if (status != 0 && status != SPNG_EOI) break;
    const Columns columns = interlaced ? adam7.at(std::size_t(place.pass)) : Columns{0, 1};
    for (int x = columns.first; x < image.width; x += columns.step) {
      for (int c = 0; c < image.channels; ++c) {
        image.at(x, int(place.row_num), c) = float(row[std::size_t(x) * 4 + std::size_t(c)]) / 65535.0f;
      }
    }
  }
  // Read to the end of the file, so that truncation is detected.
  return status == SPNG_EOI ? spng_decode_chunks(context) : status;
}

}  // namespace

bool is_png(Bytes bytes) {
  constexpr std::array<std::uint8_t, 8> signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  return bytes.size() >= signature.size() && std::equal(signature.begin(), signature.end(), bytes.begin());
}

ImageSize png_size(Bytes bytes) {
  Source source{bytes};
  spng_ihdr header{};
  if (spng_get_ihdr(open(source).get(), &header) != 0) return {};
  return {header.width, header.height};
}

Result<DecodedImage> decode_png(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  Source source{bytes};
  const Context context = open(source);
  const auto broken = [&](int status) {
    const char* const reason = source.hit_end ? "unexpected end of file" : spng_strerror(status);
    return fail_at(name, source.at, fmt::format("broken PNG: {}", reason), "save it again");
  };
  spng_ihdr header{};
  if (const int status = spng_get_ihdr(context.get(), &header); status != 0) return broken(status);
  const auto size = check_size(at_byte(name, 16), header.width, header.height, limits);
  if (!size) return tl::unexpected(size.error());
  if (!can_hold(bytes.size(), header)) {
    const auto what = fmt::format("broken PNG: the file ends here, too early for {} x {} pixels",
                                  header.width, header.height);
    return fail_at(name, bytes.size(), what, "save it again");
  }
  const int width = int(header.width), height = int(header.height);
  DecodedImage out{Image<float>(width, height, channels_of(context.get(), header)),
                   std::max<int>(8, header.bit_depth)};
  const int status = decode_rows(context.get(), header.interlace_method != 0, out.pixels);
  if (status != 0 || source.hit_end) return broken(status);
  return out;
}

}  // namespace intaglio::surface
