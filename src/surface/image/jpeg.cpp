#include <turbojpeg.h>

#include <fmt/format.h>
#include <algorithm>
#include <memory>

#include "surface/image/image_file.h"

namespace intaglio::surface {

bool is_jpeg(Bytes bytes) {
  return bytes.size() >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff;
}

ImageSize jpeg_size(Bytes bytes) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  int width = 0, height = 0, subsampling = 0, colours = 0;
  if (tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width, &height, &subsampling,
                          &colours) != 0)
    return {};
  return {std::uint64_t(width), std::uint64_t(height)};
}

Result<DecodedImage> decode_jpeg(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  const auto broken = [&] {
    const char* const reason = tjGetErrorStr2(decoder.get());
    return fail(name, fmt::format("is a broken JPEG of {} bytes: {}", bytes.size(), reason), "save it again");
  };
  int width = 0, height = 0, subsampling = 0, colours = 0;
  if (tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width, &height, &subsampling,
                          &colours) != 0) {
    return broken();
  }
  if (auto size = check_size(name, width, height, limits); !size) return tl::unexpected(size.error());
  if (colours == TJCS_CMYK || colours == TJCS_YCCK) return fail(name, "is a CMYK JPEG", "save it as RGB");

  // A truncated file is an error rather than a warning: a half-decoded texture would produce a step in the
  // relief. Files that request thousands of progressive scans of the same pixels are rejected, too.
  const bool grey = colours == TJCS_GRAY;
  Image8 image(width, height, grey ? 1 : 3);
  const int flags = TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
  if (tjDecompress2(decoder.get(), bytes.data(), bytes.size(), image.data.data(), width, 0, height,
                    grey ? TJPF_GRAY : TJPF_RGB, flags) != 0) {
    return broken();
  }
  DecodedImage out{Image<float>(width, height, image.channels)};
  std::transform(image.data.begin(), image.data.end(), out.pixels.data.begin(),
                 [](std::uint8_t v) { return float(v) / 255.0f; });
  return out;
}

}  // namespace intaglio::surface
