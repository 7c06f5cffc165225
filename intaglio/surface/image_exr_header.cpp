#include "intaglio/surface/image_exr_header.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>

namespace intaglio::surface {

namespace {

constexpr std::size_t first_attribute = 8;  // after the magic number and the version
constexpr std::uint64_t max_block_bytes = 128u << 20;
constexpr std::uint32_t max_tile_side = 4096;

// Reads little-endian values and names. What goes beyond the end comes as 0, and `ended` stays true from then
// on.
struct Cursor {
  Bytes bytes;
  std::size_t at = 0;
  bool ended = false;

  std::uint32_t number(std::size_t count = 4) {
    std::uint32_t value = 0;
    ended = ended || bytes.size() - at < count;
    for (std::size_t k = 0; k < count && !ended; ++k) value |= std::uint32_t{bytes[at++]} << (8 * k);
    return value;
  }
  int signed_number() { return static_cast<int>(number()); }
  // Up to its zero byte; at most 255 characters, which is all the format allows.
  std::string text() {
    std::string value;
    while (const auto c = static_cast<char>(number(1))) {
      value += c;
      ended = ended || value.size() > 255;
      if (ended) return {};
    }
    return value;
  }
};

// The attributes that say how the pixels are stored; size 0 is any.
struct Needed {
  const char* name;
  const char* type;
  std::size_t size;
  bool required;
};
constexpr std::array<Needed, 9> all_needed{{{"channels", "chlist", 0, true},
                                            {"compression", "compression", 1, true},
                                            {"dataWindow", "box2i", 16, true},
                                            {"displayWindow", "box2i", 16, true},
                                            {"lineOrder", "lineOrder", 1, true},
                                            {"pixelAspectRatio", "float", 4, true},
                                            {"screenWindowCenter", "v2f", 8, true},
                                            {"screenWindowWidth", "float", 4, true},
                                            {"tiles", "tiledesc", 9, false}}};

class Reader {
 public:
  Reader(Bytes bytes, const std::string& name, const ImageLimits& limits)
      : bytes_(bytes), name_(name), limits_(limits) {}

  Result<ExrHeader> read() {
    for (const auto step : {&Reader::read_version, &Reader::read_attributes, &Reader::read_window,
                            &Reader::read_channels, &Reader::read_blocks}) {
      if (auto good = (this->*step)(); !good) return tl::unexpected(good.error());
    }
    return std::move(header_);
  }

 private:
  struct Attribute {
    std::size_t at, size;
  };

  tl::unexpected<Error> broken(std::size_t at, const std::string& what) const {
    return fail_at(name_, at, "broken EXR: " + what, "save it again");
  }
  Cursor open(const std::string& attribute) const {
    const Attribute& a = attributes_.at(attribute);
    return {bytes_.subspan(a.at, a.size)};
  }
  std::size_t place_of(const std::string& attribute) const { return attributes_.at(attribute).at; }

  Result<void> read_version();
  Result<void> read_attributes();
  Result<void> keep(const std::string& name, const std::string& type, std::size_t type_at,
                    Attribute attribute);
  Result<void> read_window();
  Result<void> read_channels();
  Result<void> read_blocks();
  Result<std::array<std::uint64_t, 2>> block_size() const;

  Bytes bytes_;
  const std::string& name_;
  const ImageLimits& limits_;
  bool tiled_ = false;
  std::uint64_t bytes_per_pixel_ = 0;
  std::map<std::string, Attribute> attributes_;  // the needed ones
  ExrHeader header_;
};

Result<void> Reader::read_version() {
  constexpr std::uint32_t tiled = 0x200, long_names = 0x400, deep = 0x800, parts = 0x1000;
  Cursor cursor{bytes_, 4};
  const std::uint32_t version = cursor.number();
  if (cursor.ended) return broken(bytes_.size(), "the file ends here, within its header");
  if ((version & (deep | parts)) != 0)
    return fail_at(name_, 5, "a deep or multi-part EXR", "save it as one flat image");
  if ((version & ~(tiled | long_names)) != 2) return broken(4, fmt::format("version {:#x}", version));
  tiled_ = (version & tiled) != 0;
  return {};
}

// Attributes are name, type, size and so many bytes; an empty name ends them.
Result<void> Reader::read_attributes() {
  Cursor cursor{bytes_, first_attribute};
  header_.shown.assign(bytes_.begin(), bytes_.begin() + first_attribute);
  while (true) {
    const std::size_t start = cursor.at;
    const std::string name = cursor.text();
    if (name.empty() && !cursor.ended) break;
    const std::size_t type_at = cursor.at;
    const std::string type = cursor.text();
    const std::size_t size = cursor.number();
    if (cursor.ended || size > bytes_.size() - cursor.at)
      return broken(start, "an attribute goes beyond the end of the file");
    if (type.empty()) return broken(type_at, "an attribute without a type");
    const Attribute attribute{cursor.at, size};
    cursor.at += size;
    header_.shown.insert(header_.shown.end(), bytes_.begin() + std::ptrdiff_t(start),
                         bytes_.begin() + std::ptrdiff_t(cursor.at));
    if (auto good = keep(name, type, type_at, attribute); !good) return good;
  }
  header_.shown.push_back(0);
  for (const Needed& needed : all_needed) {
    const bool wanted = needed.required || tiled_;
    if (wanted && attributes_.count(needed.name) == 0)
      return broken(cursor.at, fmt::format("the header ends here without {}", needed.name));
  }
  return {};
}

Result<void> Reader::keep(const std::string& name, const std::string& type, std::size_t type_at,
                          Attribute attribute) {
  const auto needed =
      std::find_if(all_needed.begin(), all_needed.end(), [&](const Needed& n) { return n.name == name; });
  if (needed == all_needed.end()) {
    header_.shown[type_at] = '?';
    return {};
  }
  if (type != needed->type || (needed->size != 0 && attribute.size != needed->size)) {
    return broken(type_at, fmt::format("{} is {} of {} bytes", name, type, attribute.size));
  }
  if (!attributes_.emplace(name, attribute).second)
    return broken(type_at, fmt::format("{} comes twice", name));
  return {};
}

Result<void> Reader::read_window() {
  Cursor cursor = open("dataWindow");
  const std::int64_t left = cursor.signed_number(), top = cursor.signed_number();
  const std::int64_t width = cursor.signed_number() - left + 1, height = cursor.signed_number() - top + 1;
  if (auto size = check_size(at_byte(name_, place_of("dataWindow")), width, height, limits_); !size)
    return size;
  header_.left = static_cast<int>(left);
  header_.top = static_cast<int>(top);
  header_.width = static_cast<int>(width);
  header_.height = static_cast<int>(height);
  return {};
}

Result<void> Reader::read_channels() {
  Cursor cursor = open("channels");
  const std::size_t start = header_.channels_at = place_of("channels");
  while (true) {
    const std::size_t at = start + cursor.at;
    const std::string channel = cursor.text();
    if (channel.empty()) break;
    const std::uint32_t sample = cursor.number();
    cursor.number();  // perceptually linear or not: a hint for lossy writers
    const std::uint32_t x_step = cursor.number(), y_step = cursor.number();
    if (cursor.ended || sample > 2)
      return broken(at, fmt::format("channel {} is cut or of an unknown type", channel));
    if (x_step != 1 || y_step != 1)
      return fail_at(name_, at, fmt::format("channel {} is subsampled", channel),
                     "save it at full size, as RGB");
    header_.channels.push_back({channel, static_cast<ExrSample>(sample)});
    bytes_per_pixel_ += header_.channels.back().sample == ExrSample::half ? 2 : 4;
  }
  if (cursor.ended || cursor.at != cursor.bytes.size()) return broken(start, "the list of channels is cut");
  if (header_.channels.empty()) return broken(start, "no channels");
  return {};
}

// Width and height of what is compressed at once: a tile, or some rows.
Result<std::array<std::uint64_t, 2>> Reader::block_size() const {
  constexpr std::array<std::uint64_t, 10> rows{
      1, 1, 1, 16, 32, 16, 32, 32, 32, 256};  // none RLE ZIPS ZIP PIZ PXR24 B44 B44A DWAA DWAB
  const std::uint32_t compression = open("compression").number(1);
  if (compression >= rows.size())
    return broken(place_of("compression"), fmt::format("unknown compression {}", compression));
  if (!tiled_) return std::array{std::uint64_t(header_.width), rows[compression]};
  Cursor cursor = open("tiles");
  const std::uint32_t width = cursor.number(), height = cursor.number(), mode = cursor.number(1);
  const bool known_mode = (mode & 0x0f) <= 2 && (mode >> 4) <= 1;
  if (width == 0 || height == 0 || width > max_tile_side || height > max_tile_side || !known_mode) {
    return broken(place_of("tiles"), fmt::format("tiles of {} x {} pixels, mode {}", width, height, mode));
  }
  return std::array{std::uint64_t{width}, std::uint64_t{height}};
}

// After the header comes a table of 8 bytes for each block: no file has more blocks than it has room for.
Result<void> Reader::read_blocks() {
  const auto block = block_size();
  if (!block) return tl::unexpected(block.error());
  const auto [width, height] = *block;
  if (width * height * bytes_per_pixel_ > max_block_bytes) {
    return fail_at(name_, place_of("channels"),
                   fmt::format("blocks of {} x {} pixels of {} bytes", width, height, bytes_per_pixel_),
                   "save only the channels that matter");
  }
  const auto round_up = [](int side, std::uint64_t step) { return (std::uint64_t(side) + step - 1) / step; };
  const std::uint64_t blocks = round_up(header_.width, width) * round_up(header_.height, height);
  if (blocks * 8 > bytes_.size() - header_.shown.size()) {
    return broken(bytes_.size(),
                  fmt::format("the file ends here, too early for a table of {} blocks", blocks));
  }
  return {};
}

}  // namespace

Result<ExrHeader> read_exr_header(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  return Reader(bytes, name, limits).read();
}

}  // namespace intaglio::surface
