#include "surface/image/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/file.h"
#include "core/text.h"

namespace intaglio::surface {

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
  const bool fits =
      width <= limits.side && height <= limits.side && std::uint64_t(width * height) <= limits.pixels;
  if (fits) return {};
  return fail(where, is,
              fmt::format("at most {0} x {0} and {1} pixels are read", limits.side, limits.pixels));
}

bool has_image_extension(const std::filesystem::path& path) {
  constexpr std::array extensions{".png", ".jpg", ".jpeg", ".tga", ".exr"};
  return std::find(extensions.begin(), extensions.end(), lower_case(path.extension().string())) !=
         extensions.end();
}

Result<DecodedImage> decode_image(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  if (bytes.empty()) {
    return fail(name, "is an empty file (0 bytes)", "a PNG, JPEG, TGA or EXR image is needed");
  }
  if (is_png(bytes)) return decode_png(bytes, name, limits);
  if (is_jpeg(bytes)) return decode_jpeg(bytes, name, limits);
  if (is_exr(bytes)) return decode_exr(bytes, name, limits);
  if (lower_case(std::filesystem::path(name).extension().string()) == ".tga" || may_be_tga(bytes))
    return decode_tga(bytes, name, limits);
  return fail_at(name, 0, "no PNG, JPEG, TGA or EXR image starts like this", "convert it to PNG");
}

namespace {

ImageSize declared_size(Bytes bytes) {
  const ImageSize size = is_png(bytes)    ? png_size(bytes)
                         : is_jpeg(bytes) ? jpeg_size(bytes)
                         : is_exr(bytes)  ? exr_size(bytes)
                                          : tga_size(bytes);
  const bool is_read = check_size("", std::int64_t(size.width), std::int64_t(size.height), {}).has_value();
  return is_read ? size : ImageSize();
}

}  // namespace

ImageSize read_image_size(const std::filesystem::path& path) {
  constexpr std::size_t most_headers = 1u << 20;
  const auto head = read_head(path, most_headers);
  if (!head) return {};
  const ImageSize size = declared_size(*head);
  if (size.pixels() > 0 || head->size() < most_headers) return size;
  const auto whole = read_file(path, max_image_file_bytes);
  return whole ? declared_size(*whole) : ImageSize();
}

Result<DecodedImage> read_image(const std::filesystem::path& path) {
  const auto bytes = read_file(path, max_image_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return decode_image(*bytes, path.string());
}

}  // namespace intaglio::surface
