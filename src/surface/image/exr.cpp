// EXR. The header is read and bounded before OpenEXR sees the file, because OpenEXR allocates what a header
// requests before it checks whether the file has it. Source: "OpenEXR File Layout", openexr.com.
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "surface/image/image_file.h"

namespace intaglio::surface {

namespace {

enum class ExrSample { uint32 = 0, half = 1, single = 2 };  // as numbered in files

struct ExrChannel {
  std::string name;
  ExrSample sample;
};

struct ExrHeader {
  int left = 0, top = 0;  // the data window's first pixel; may be negative
  int width = 0, height = 0;
  std::vector<ExrChannel> channels;
  std::size_t channels_at = 0;  // byte where their list begins
  // The header bytes passed to OpenEXR. Attributes irrelevant to the pixels (previews, manifests, lists of
  // strings) get an unknown type, so that OpenEXR skips them instead of allocating their claimed size.
  std::vector<std::uint8_t> sanitised;
};

constexpr std::size_t first_attribute = 8;  // after the magic number and the version
constexpr std::uint64_t max_block_bytes = 128u << 20;
constexpr std::uint32_t max_tile_side = 4096;

// Little-endian reader. Reads past the end return 0 and set `ended`.
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
  int signed_number() { return int(number()); }
  // Text up to its zero byte; at most 255 characters, the limit of the format.
  std::string text() {
    std::string value;
    while (const auto c = char(number(1))) {
      value += c;
      ended = ended || value.size() > 255;
      if (ended) return {};
    }
    return value;
  }
};

// The attributes that describe the storage of the pixels; size 0 is any.
struct KnownAttribute {
  const char* name;
  const char* type;
  std::size_t size;
  bool required;
};
constexpr std::array<KnownAttribute, 9> known_attributes{{{"channels", "chlist", 0, true},
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

  ImageSize size() {
    for (const auto step : {&Reader::read_version, &Reader::read_attributes, &Reader::read_window})
      if (!(this->*step)()) return {};
    return {std::uint64_t(header_.width), std::uint64_t(header_.height)};
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
  Result<void> store_attribute(const std::string& name, const std::string& type, std::size_t type_at,
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
  std::map<std::string, Attribute> attributes_;  // the known ones
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

// Attributes are name, type, size and that many bytes; an empty name ends them.
Result<void> Reader::read_attributes() {
  Cursor cursor{bytes_, first_attribute};
  header_.sanitised.assign(bytes_.begin(), bytes_.begin() + first_attribute);
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
    header_.sanitised.insert(header_.sanitised.end(), bytes_.begin() + std::ptrdiff_t(start),
                             bytes_.begin() + std::ptrdiff_t(cursor.at));
    if (auto good = store_attribute(name, type, type_at, attribute); !good) return good;
  }
  header_.sanitised.push_back(0);
  for (const KnownAttribute& known : known_attributes) {
    const bool needed = known.required || tiled_;
    if (needed && attributes_.count(known.name) == 0)
      return broken(cursor.at, fmt::format("the header ends here without {}", known.name));
  }
  return {};
}

Result<void> Reader::store_attribute(const std::string& name, const std::string& type, std::size_t type_at,
                                     Attribute attribute) {
  const auto known = std::find_if(known_attributes.begin(), known_attributes.end(),
                                  [&](const KnownAttribute& n) { return n.name == name; });
  if (known == known_attributes.end()) {
    header_.sanitised[type_at] = '?';
    return {};
  }
  if (type != known->type || (known->size != 0 && attribute.size != known->size)) {
    return broken(type_at, fmt::format("{} is {} of {} bytes", name, type, attribute.size));
  }
  if (!attributes_.emplace(name, attribute).second)
    return broken(type_at, fmt::format("{} appears twice", name));
  return {};
}

Result<void> Reader::read_window() {
  Cursor cursor = open("dataWindow");
  const std::int64_t left = cursor.signed_number(), top = cursor.signed_number();
  const std::int64_t width = cursor.signed_number() - left + 1, height = cursor.signed_number() - top + 1;
  if (auto size = check_size(at_byte(name_, place_of("dataWindow")), width, height, limits_); !size)
    return size;
  header_.left = int(left);
  header_.top = int(top);
  header_.width = int(width);
  header_.height = int(height);
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
      return broken(at, fmt::format("channel {} is truncated or of an unknown type", channel));
    if (x_step != 1 || y_step != 1)
      return fail_at(name_, at, fmt::format("channel {} is subsampled", channel),
                     "save it at full size, as RGB");
    header_.channels.push_back({channel, static_cast<ExrSample>(sample)});
    bytes_per_pixel_ += header_.channels.back().sample == ExrSample::half ? 2 : 4;
  }
  if (cursor.ended || cursor.at != cursor.bytes.size()) return broken(start, "the channel list is truncated");
  if (header_.channels.empty()) return broken(start, "no channels");
  return {};
}

// Size of one compression block: a tile, or some rows.
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

// After the header comes a table with 8 bytes for each block, which bounds their number by the file's size.
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
  if (blocks * 8 > bytes_.size() - header_.sanitised.size()) {
    return broken(bytes_.size(),
                  fmt::format("the file ends here, too early for a table of {} blocks", blocks));
  }
  return {};
}

// Errors: not a flat single-part image; sizes beyond the limits; attributes that are missing, duplicate, or
// of the wrong size; blocks of pixels larger than 128 MiB; more blocks than the file has room for.
Result<ExrHeader> read_exr_header(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  return Reader(bytes, name, limits).read();
}

// --- Pixels ---

// An in-memory file that presents the sanitised header, which is as long as the file's own.
class MemoryStream : public Imf::IStream {
 public:
  MemoryStream(Bytes bytes, Bytes header, const std::string& name)
      : IStream(name.c_str()), bytes_(bytes), header_(header) {}

  bool read(char to[], int count) override {
    const std::uint64_t end = at_ + std::uint64_t(std::max(count, 0));
    if (count < 0 || at_ > bytes_.size() || end > bytes_.size()) {
      at_ = bytes_.size();
      throw std::runtime_error("unexpected end of file");
    }
    for (; at_ < std::min<std::uint64_t>(end, header_.size()); ++at_) *to++ = char(header_[at_]);
    if (end > at_) std::memcpy(to, bytes_.data() + at_, end - at_);
    at_ = end;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

  std::uint64_t place() const { return std::min<std::uint64_t>(at_, bytes_.size()); }

 private:
  Bytes bytes_, header_;
  std::uint64_t at_ = 0;
};

// The channels to read, in the order of the image's: R G B (A), Y (A) or the only one.
Result<std::vector<ExrChannel>> choose_channels(const ExrHeader& header, const std::string& name) {
  if (header.channels.size() == 1) return header.channels;
  std::vector<ExrChannel> chosen;
  const auto take = [&](const char* wanted) {
    const auto found = std::find_if(header.channels.begin(), header.channels.end(),
                                    [&](const ExrChannel& c) { return c.name == wanted; });
    if (found != header.channels.end()) chosen.push_back(*found);
    return found != header.channels.end();
  };
  const bool colour = take("R") && take("G") && take("B");
  if (!colour) chosen.clear();
  if (colour || take("Y")) {
    take("A");
    return chosen;
  }
  std::string all;
  for (const ExrChannel& channel : header.channels) all += (all.empty() ? "" : ", ") + channel.name;
  return fail_at(name, header.channels_at, "an EXR with the channels " + all,
                 "save R G B (A), Y, or one channel");
}

// The image's channel for channel k of `count` chosen ones: Y A becomes R G B A.
int channel_index(std::size_t k, std::size_t count) {
  return count == 2 && k == 1 ? 3 : int(k);
}

Imf::FrameBuffer frame_buffer(const ExrHeader& header, const std::vector<ExrChannel>& chosen,
                              Image<float>& image) {
  const Imath::Box2i window({header.left, header.top},
                            {header.left + (header.width - 1), header.top + (header.height - 1)});
  const std::size_t pixel = std::size_t(image.channels) * sizeof(float);
  Imf::FrameBuffer buffer;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    float* const first = &image.at(0, 0, channel_index(k, chosen.size()));
    buffer.insert(chosen[k].name,
                  Imf::Slice::Make(Imf::FLOAT, first, window, pixel, pixel * std::size_t(image.width)));
  }
  return buffer;
}

Result<void> check_finite(const Image<float>& image, const std::string& name) {
  const auto bad =
      std::find_if(image.data.begin(), image.data.end(), [](float v) { return !std::isfinite(v); });
  if (bad == image.data.end()) return {};
  const auto pixel = std::size_t(bad - image.data.begin()) / std::size_t(image.channels);
  const auto x = pixel % std::size_t(image.width), y = pixel / std::size_t(image.width);
  return fail(name, fmt::format("the pixel in column {}, row {} (from the top left, 0) is {}", x, y, *bad),
              "every pixel must be a finite number");
}

void spread_grey(Image<float>& image) {
  for (std::size_t p = 0; p < image.data.size(); p += 4) {
    image.data[p + 1] = image.data[p + 2] = image.data[p];
  }
}

}  // namespace

bool is_exr(Bytes bytes) {
  constexpr std::array<std::uint8_t, 4> magic{0x76, 0x2f, 0x31, 0x01};
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

ImageSize exr_size(Bytes bytes) {
  return Reader(bytes, "", {}).size();
}

Result<DecodedImage> decode_exr(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  if (!is_exr(bytes)) return fail_at(name, 0, "not an EXR", "save it again");
  const auto header = read_exr_header(bytes, name, limits);
  if (!header) return tl::unexpected(header.error());
  const auto chosen = choose_channels(*header, name);
  if (!chosen) return tl::unexpected(chosen.error());
  const auto uses = [&](ExrSample sample) {
    return std::any_of(chosen->begin(), chosen->end(),
                       [&](const ExrChannel& c) { return c.sample == sample; });
  };
  if (uses(ExrSample::uint32)) {
    return fail_at(name, header->channels_at, "an EXR with integer samples", "save it as half or float");
  }

  const int channels = chosen->size() == 2 ? 4 : int(chosen->size());
  DecodedImage out{Image<float>(header->width, header->height, channels), uses(ExrSample::single) ? 32 : 16};
  MemoryStream stream(bytes, header->sanitised, name);
  try {
    Imf::InputFile file(stream, 0);
    file.setFrameBuffer(frame_buffer(*header, *chosen, out.pixels));
    file.readPixels(header->top, header->top + (header->height - 1));
  } catch (const std::exception& error) {
    return fail_at(name, stream.place(), fmt::format("broken EXR: {}", error.what()), "save it again");
  }
  if (auto finite = check_finite(out.pixels, name); !finite) return tl::unexpected(finite.error());
  if (chosen->size() == 2) spread_grey(out.pixels);
  return out;
}

}  // namespace intaglio::surface
