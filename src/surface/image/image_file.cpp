#include "surface/image/image_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>

#include "core/file.h"

namespace intaglio::surface {

namespace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  const auto lower = [](unsigned char c) { return static_cast<char>(std::tolower(c)); };
  std::transform(text.begin(), text.end(), text.begin(), lower);
  return text;
}

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return text;
}

}  // namespace

std::string at_byte(const std::string& name, std::uint64_t byte) {
  return fmt::format("{}: byte {}", name, byte);
}

tl::unexpected<Error> fail_at(const std::string& name, std::uint64_t byte, std::string what,
                              std::string fix) {
  return fail(at_byte(name, byte), printable(std::move(what)), printable(std::move(fix)));
}

Result<void> check_size(const std::string& where, std::int64_t width, std::int64_t height,
                        const ImageLimits& limits) {
  const std::string is = fmt::format("the image is {} x {} pixels", width, height);
  if (width <= 0 || height <= 0) return fail(where, is, "an image has at least one");
  const bool fits = width <= limits.side && height <= limits.side &&
                    static_cast<std::uint64_t>(width * height) <= limits.pixels;
  if (fits) return {};
  return fail(where, is,
              fmt::format("at most {0} x {0} and {1} pixels are read", limits.side, limits.pixels));
}

bool has_image_extension(const std::filesystem::path& path) {
  constexpr std::array extensions{".png", ".jpg", ".jpeg", ".tga", ".exr"};
  return std::find(extensions.begin(), extensions.end(), lower_extension(path)) != extensions.end();
}

Result<DecodedImage> decode_image(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  if (bytes.empty()) {
    return fail(name, "is an empty file (0 bytes)", "a PNG, JPEG, TGA or EXR image is needed");
  }
  if (is_png(bytes)) return decode_png(bytes, name, limits);
  if (is_jpeg(bytes)) return decode_jpeg(bytes, name, limits);
  if (is_exr(bytes)) return decode_exr(bytes, name, limits);
  if (lower_extension(name) == ".tga" || may_be_tga(bytes)) return decode_tga(bytes, name, limits);
  return fail_at(name, 0, "no PNG, JPEG, TGA or EXR image starts like this", "convert it to PNG");
}

Result<DecodedImage> read_image(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return decode_image(*bytes, path.string());
}

}  // namespace intaglio::surface
