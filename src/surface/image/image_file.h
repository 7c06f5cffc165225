// Image files, decoded from memory, with limits on what untrusted files may request:
//   PNG    1 to 16 bits a sample, palette, interlaced                                          libspng
//   JPEG   baseline and progressive, grey or colour                                            libjpeg-turbo
//   TGA    grey 8 bit, true colour 24 and 32 bit; raw and run-length; all four origins         tga.cpp
//   EXR    scan lines or tiles, half or float; R G B (A), Y (A), or one channel of any name    OpenEXR
// The format is recognised by the file's first bytes; TGA has no signature and is recognised by ".tga" or by
// a plausible header. The declared size is checked before anything of that size is allocated. Errors name the
// file and the byte, or, for JPEG, whose decoder does not report the offset, the file's size. Any thread; no
// threads are started.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "intaglio/error.h"
#include "intaglio/image.h"

namespace intaglio::surface {

// Larger files are not read.
inline constexpr std::uintmax_t max_image_file_bytes = 512u << 20;

// Larger images are rejected.
struct ImageLimits {
  std::uint32_t side = 16384;
  std::uint64_t pixels = 64ull << 20;
};

struct DecodedImage {
  // 1 (grey), 3 (RGB) or 4 (RGBA) channels; row 0 = top and column 0 = left, whatever the order in the file.
  // Integer samples are v / (2^bits - 1), so 0..1; EXR samples are as stored, and finite. Neither is
  // gamma-decoded, and colour is not divided by alpha. A TGA of 32 bits keeps its alpha even where its header
  // claims 0 alpha bits, as game tools write it.
  Image<float> pixels;
  int bit_depth = 8;                  // of a sample: 8 (or fewer), 16 (also half) or 32 (float)
  bool rows_flipped_in_file = false;  // the file stores the bottom row first, as most TGA files do
};

// `name` begins every error; its extension matters only for TGA.
// Fuzzed by fuzz/import.cpp through import_texture
Result<DecodedImage> decode_image(std::span<const std::uint8_t> bytes, const std::string& name,
                                  const ImageLimits& limits = {});
Result<DecodedImage> read_image(const std::filesystem::path& path);

struct ImageSize {
  std::uint64_t width = 0, height = 0;

  std::uint64_t pixels() const { return width * height; }
};
// The size that a file's header declares; zero where it cannot be read, or is beyond the limits, which
// decode_image() reports. Reads the first part of a file only, or all of it when its header is longer.
ImageSize read_image_size(const std::filesystem::path& path);

// Whether the extension is .png, .jpg, .jpeg, .tga or .exr, in any case.
bool has_image_extension(const std::filesystem::path& path);

// --- Internal to surface/image/: a decoder per format, and what they share ---

using Bytes = std::span<const std::uint8_t>;

bool is_png(Bytes bytes);
bool is_jpeg(Bytes bytes);
bool is_exr(Bytes bytes);
bool may_be_tga(Bytes bytes);  // the header is plausible

Result<DecodedImage> decode_png(Bytes bytes, const std::string& name, const ImageLimits& limits);
Result<DecodedImage> decode_jpeg(Bytes bytes, const std::string& name, const ImageLimits& limits);
Result<DecodedImage> decode_tga(Bytes bytes, const std::string& name, const ImageLimits& limits);
Result<DecodedImage> decode_exr(Bytes bytes, const std::string& name, const ImageLimits& limits);

// The declared sizes; zero where the bytes end too early or are no such header.
ImageSize png_size(Bytes bytes);
ImageSize jpeg_size(Bytes bytes);
ImageSize tga_size(Bytes bytes);
ImageSize exr_size(Bytes bytes);

// An error at a byte of the file. Text from files and libraries is sanitised to printable ASCII.
tl::unexpected<Error> fail_at(const std::string& name, std::uint64_t byte, std::string what,
                              std::string fix = {});

// Whether a declared size is within the limits. `where` is the file, or the file and the byte that declares
// it.
Result<void> check_size(const std::string& where, std::int64_t width, std::int64_t height,
                        const ImageLimits& limits);

std::string at_byte(const std::string& name, std::uint64_t byte);  // "name: byte 12"

}  // namespace intaglio::surface
