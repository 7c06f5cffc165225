// A folder of small images into import: whatever names, sizes, pixels and options the bytes choose, a
// consistent texture or one clear error on one line. The images are valid (fuzz/image.cpp breaks them): TGA,
// PNG of 16 bits, and EXR, whose numbers may be any.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "fuzz/require.h"
#include "intaglio/image.h"
#include "surface/import.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::surface;
using fuzz::require;

namespace {

using Bytes = std::vector<std::uint8_t>;

struct Size {
  int width, height;
};

// Samples of a map: random, or a slope with a little noise, as real maps are.
std::uint8_t sample(FuzzedDataProvider& in, int x, int y, int channel, bool is_smooth) {
  if (!is_smooth) return in.ConsumeIntegral<std::uint8_t>();
  return std::uint8_t(channel == 2 ? 240 : 128 + 3 * (x - y) + (in.ConsumeIntegral<std::uint8_t>() & 7));
}

Bytes make_tga(FuzzedDataProvider& in, Size size) {
  const int channels = in.PickValueInArray({1, 3, 4});
  Bytes bytes(18);
  bytes[2] = channels == 1 ? 3 : 2;
  bytes[12] = std::uint8_t(size.width);
  bytes[14] = std::uint8_t(size.height);
  bytes[16] = std::uint8_t(8 * channels);
  bytes[17] = std::uint8_t(in.ConsumeIntegralInRange(0, 3) << 4);
  const bool is_smooth = in.ConsumeBool();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < channels; ++c)
        bytes.push_back(sample(in, x, y, channels == 1 ? 0 : 2 - c, is_smooth));
  return bytes;
}

Bytes make_png(FuzzedDataProvider& in, Size size) {
  Image16 image(size.width, size.height, in.PickValueInArray({1, 3, 4}));
  const bool is_smooth = in.ConsumeBool();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < image.channels; ++c)
        image.at(x, y, c) = std::uint16_t(257 * sample(in, x, y, c, is_smooth));
  return encode_png(image);
}

// Scan lines of one uncompressed float channel.
Bytes make_exr(FuzzedDataProvider& in, Size size) {
  Bytes bytes;
  const auto put = [&](const void* from, std::size_t count) {
    const auto* first = static_cast<const std::uint8_t*>(from);
    bytes.insert(bytes.end(), first, first + count);
  };
  const auto integer = [&](std::int32_t value) { put(&value, 4); };
  const auto text = [&](const char* value) { put(value, std::strlen(value) + 1); };
  const auto box = [&](const char* name) {
    text(name), text("box2i"), integer(16), integer(0), integer(0), integer(size.width - 1),
        integer(size.height - 1);
  };
  const auto single = [&](float value) { put(&value, 4); };
  const auto letter = [&](const char* name, const char* type) {
    text(name), text(type), integer(1), bytes.push_back(0);
  };
  integer(20000630), integer(2);
  text("channels"), text("chlist"), integer(19), text("Y"), integer(2), integer(0), integer(1), integer(1),
      bytes.push_back(0);
  letter("compression", "compression");
  box("dataWindow"), box("displayWindow");
  letter("lineOrder", "lineOrder");
  text("pixelAspectRatio"), text("float"), integer(4), single(1);
  text("screenWindowCenter"), text("v2f"), integer(8), single(0), single(0);
  text("screenWindowWidth"), text("float"), integer(4), single(1);
  bytes.push_back(0);
  const std::size_t table = bytes.size(), row = 8 + 4 * std::size_t(size.width);
  for (int y = 0; y < size.height; ++y) {
    const std::uint64_t offset = table + 8 * std::size_t(size.height) + std::size_t(y) * row;
    put(&offset, 8);
  }
  for (int y = 0; y < size.height; ++y) {
    integer(y), integer(4 * size.width);
    for (int x = 0; x < size.width; ++x)
      single(in.ConsumeBool() ? in.ConsumeFloatingPoint<float>() : 0.1f * float(x - y));
  }
  return bytes;
}

void write_image(FuzzedDataProvider& in, const std::filesystem::path& folder, const char* role) {
  const Size size{in.ConsumeIntegralInRange(1, 16), in.ConsumeIntegralInRange(1, 16)};
  static constexpr const char* extensions[] = {".tga", ".png", ".exr"};
  const auto format = in.ConsumeIntegralInRange<std::size_t>(0, 2);
  const Bytes bytes = format == 0   ? make_tga(in, size)
                      : format == 1 ? make_png(in, size)
                                    : make_exr(in, size);
  std::ofstream file(folder / (std::string("tile") + role + extensions[format]), std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

ImportOptions options_of(FuzzedDataProvider& in) {
  ImportOptions options;
  if (in.ConsumeBool()) options.green = in.ConsumeBool() ? Green::plus_y : Green::minus_y;
  if (in.ConsumeBool()) options.polarity = in.ConsumeBool() ? Polarity::depth : Polarity::height;
  if (in.ConsumeBool()) options.flip_height_rows = in.ConsumeBool();
  if (in.ConsumeBool()) options.depth_fraction = in.PickValueInArray({0.0, 1e-4, 0.02, 0.5, 1.0});
  if (in.ConsumeBool()) options.mode = ImportMode::raw;
  if (in.ConsumeBool()) options.edge = Edge::clamp;
  return options;
}

void examine(const Imported& imported) {
  const Texels& texels = imported.texels;
  const auto count = std::size_t(texels.width) * std::size_t(texels.height);
  require(texels.normal.size() == count && (texels.depth.empty() || texels.depth.size() == count));
  for (const Vec3& n : texels.normal) require(std::abs(n.norm() - 1) < 1e-6 && n.z() > 0);
  for (const float depth : texels.depth) require(depth >= -1e-6f && depth <= 1 + 1e-6f);
  require(std::isfinite(imported.depth_fraction) && imported.depth_fraction >= 0);
  require(!texels.colour.data.empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const tests::TemporaryFolder folder;
  FuzzedDataProvider in(data, size);
  const ImportOptions options = options_of(in);
  static constexpr const char* roles[] = {"_nor_gl", "_nor_dx", "_height", "_color", "", "_rough"};
  for (int k = in.ConsumeIntegralInRange(1, 3); k > 0; --k)
    write_image(in, folder.path, roles[in.ConsumeIntegralInRange<std::size_t>(0, std::size(roles) - 1)]);
  std::filesystem::path path = folder.path;
  if (in.ConsumeBool()) path = std::filesystem::directory_iterator(folder.path)->path();
  const auto imported = import_texture(path, options);
  if (imported)
    examine(*imported);
  else
    fuzz::require_clear(imported.error(), folder.path.string());
  for (const auto& file : std::filesystem::directory_iterator(folder.path)) std::filesystem::remove(file);
  return 0;
}
