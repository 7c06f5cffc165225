// TGA: an 18-byte header, an optional id and colour map, then pixels as B G R (A), raw or in run-length
// packets. Source: Truevision TGA File Format Specification, version 2.0, 1991. The footer of version 2
// contains nothing we need.
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <optional>

#include "surface/image/image_file.h"

namespace intaglio::surface {

namespace {

constexpr std::size_t header_size = 18;

enum Type : int { colour_mapped = 1, true_colour = 2, grey = 3, run_length = 8 };

struct Header {
  int id_length, map_type, type, map_length, map_bits, width, height, bits, descriptor;

  bool is_run_length() const { return (type & run_length) != 0; }
  int kind() const { return type & ~run_length; }
  bool right_to_left() const { return (descriptor & 0x10) != 0; }
  bool bottom_up() const { return (descriptor & 0x20) == 0; }
  int alpha_bits() const { return descriptor & 0x0f; }
  int bytes_per_pixel() const { return bits / 8; }
  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  // A colour map may be present even in true colour; it is skipped.
  std::size_t first_pixel_byte() const {
    const int map = map_type == 1 ? map_length * ((map_bits + 7) / 8) : 0;
    return header_size + std::size_t(id_length + map);
  }
};

std::optional<Header> read_header(Bytes b) {
  if (b.size() < header_size) return std::nullopt;
  const auto word = [&](std::size_t at) { return b[at] | b[at + 1] << 8; };
  return Header{b[0], b[1], b[2], word(5), b[7], word(12), word(14), b[16], b[17]};
}

Result<void> check_header(const Header& header, const std::string& name, const ImageLimits& limits) {
  if (header.kind() == colour_mapped)
    return fail_at(name, 2, "a colour-mapped TGA", "save it as true colour");
  if (header.kind() != true_colour && header.kind() != grey) {
    return fail_at(name, 2, fmt::format("TGA image type {}", header.type), "2, 3, 10 and 11 are read");
  }
  if (auto size = check_size(at_byte(name, 12), header.width, header.height, limits); !size) return size;
  const bool known_bits = header.kind() == grey ? header.bits == 8 : header.bits == 24 || header.bits == 32;
  if (!known_bits) {
    return fail_at(name, 16, fmt::format("{} bits a pixel", header.bits), "a TGA has 8 (grey), 24 or 32");
  }
  const int alpha = header.alpha_bits();
  if (header.bits == 32 && alpha != 0 && alpha != 8) {
    return fail_at(name, 17, fmt::format("{} bits of alpha", alpha), "a TGA of 32 bits has 8");
  }
  if ((header.descriptor & 0xc0) != 0) return fail_at(name, 17, "an interleaved TGA", "save it again");
  return {};
}

// Checks the minimum file size before allocating.
Result<void> check_length(const Header& header, Bytes bytes, const std::string& name) {
  const auto pixel = std::size_t(header.bytes_per_pixel());
  const std::size_t max_in_packet = 128;
  const std::size_t packets = (header.pixels() + max_in_packet - 1) / max_in_packet;
  const std::size_t min_bytes =
      header.first_pixel_byte() + (header.is_run_length() ? packets * (1 + pixel) : header.pixels() * pixel);
  if (bytes.size() >= min_bytes) return {};
  return fail_at(name, bytes.size(),
                 fmt::format("broken TGA: the file ends here, but {} x {} pixels take {} bytes or more",
                             header.width, header.height, min_bytes),
                 "save it again");
}

// Receives pixels in the file's order and stores them in the image's.
class PixelWriter {
 public:
  PixelWriter(const Header& header, Image<float>& image) : header_(header), image_(image) {}

  std::size_t left() const { return header_.pixels() - count_; }

  // Appends the pixel whose B G R (A) or grey samples are at `samples`, `times` times; requires left() >=
  // times.
  void put(const std::uint8_t* samples, std::size_t times) {
    constexpr std::array<int, 4> bgra{2, 1, 0, 3};
    std::array<float, 4> pixel{};
    for (int c = 0; c < image_.channels; ++c) {
      const int at = image_.channels == 1 ? 0 : bgra[std::size_t(c)];
      pixel[std::size_t(c)] = float(samples[at]) / 255.0f;
    }
    for (; times > 0; --times) put(pixel);
  }

 private:
  void put(const std::array<float, 4>& pixel) {
    const int x = header_.right_to_left() ? header_.width - 1 - x_ : x_;
    const int y = header_.bottom_up() ? header_.height - 1 - y_ : y_;
    std::copy_n(pixel.begin(), image_.channels, &image_.at(x, y, 0));
    ++count_;
    if (++x_ < header_.width) return;
    x_ = 0;
    ++y_;
  }

  const Header& header_;
  Image<float>& image_;
  std::size_t count_ = 0;
  int x_ = 0, y_ = 0;  // of the next pixel, in the file's order
};

void decode_raw(const Header& header, Bytes bytes, PixelWriter& writer) {
  const auto pixel = std::size_t(header.bytes_per_pixel());
  for (std::size_t at = header.first_pixel_byte(); writer.left() > 0; at += pixel) writer.put(&bytes[at], 1);
}

// A packet is one byte, count - 1 with the top bit set for a run, then one pixel for a run or `count` pixels.
// Packets may cross rows: version 2 forbids it, but older files do it.
Result<void> decode_packets(const Header& header, Bytes bytes, PixelWriter& writer, const std::string& name) {
  const auto pixel = std::size_t(header.bytes_per_pixel());
  std::size_t at = header.first_pixel_byte();
  const auto ends = [&] {
    return fail_at(name, bytes.size(),
                   fmt::format("broken TGA: the file ends here, {} pixels too early", writer.left()),
                   "save it again");
  };
  while (writer.left() > 0) {
    if (at >= bytes.size()) return ends();
    const std::size_t packet = at++;
    const std::size_t count = (bytes[packet] & 0x7fu) + 1;
    const bool run = (bytes[packet] & 0x80) != 0;
    if (count > writer.left()) {
      return fail_at(name, packet,
                     fmt::format("broken TGA: a packet of {} pixels where {} are left", count, writer.left()),
                     "save it again");
    }
    const std::size_t stored = run ? 1 : count;
    if (bytes.size() - at < stored * pixel) return ends();
    for (std::size_t k = 0; k < stored; ++k) writer.put(&bytes[at + k * pixel], run ? count : 1);
    at += stored * pixel;
  }
  return {};
}

}  // namespace

bool may_be_tga(Bytes bytes) {
  const auto header = read_header(bytes);
  if (!header || header->map_type > 1 || header->width == 0 || header->height == 0) return false;
  constexpr std::array<int, 5> depths{8, 15, 16, 24, 32};
  const bool known_type =
      header->type <= (grey | run_length) && header->kind() >= colour_mapped && header->kind() <= grey;
  return known_type && std::find(depths.begin(), depths.end(), header->bits) != depths.end();
}

ImageSize tga_size(Bytes bytes) {
  const auto header = read_header(bytes);
  return header ? ImageSize{std::uint64_t(header->width), std::uint64_t(header->height)} : ImageSize();
}

Result<DecodedImage> decode_tga(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  const auto header = read_header(bytes);
  if (!header)
    return fail_at(name, bytes.size(), "broken TGA: the file ends here, within its header", "save it again");
  if (auto good = check_header(*header, name, limits); !good) return tl::unexpected(good.error());
  if (auto good = check_length(*header, bytes, name); !good) return tl::unexpected(good.error());
  DecodedImage out{Image<float>(header->width, header->height, header->bytes_per_pixel()), 8,
                   header->bottom_up()};
  PixelWriter writer(*header, out.pixels);
  if (!header->is_run_length()) {
    decode_raw(*header, bytes, writer);
  } else if (auto good = decode_packets(*header, bytes, writer, name); !good) {
    return tl::unexpected(good.error());
  }
  return out;
}

}  // namespace intaglio::surface
