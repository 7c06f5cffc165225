// Writers of image files for the tests of their readers: TGA and PNG by hand, JPEG and EXR by their own
// libraries.
#pragma once

#include <OpenEXR/ImfCompression.h>

#include <cstdint>
#include <string>
#include <vector>

#include "intaglio/image.h"

namespace intaglio::surface::encoders {

using File = std::vector<std::uint8_t>;

struct TgaLayout {
  bool run_length = false;  // packets go on over the ends of rows
  bool right_to_left = false;
  bool top_down = false;
  int alpha_bits = 8;  // what the header of a 32-bit file claims
  std::string id = {};
};
File encode_tga(const Image8& image, const TgaLayout& layout = {});  // 1, 3 or 4 channels

struct ExrLayout {
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  bool half = false;
  bool tiled = false;
  int left = 0, top = 0;              // of the data window
  std::vector<std::string> channels;  // empty: Y, R G B or R G B A
  bool preview = false;
};
File encode_exr(const Image<float>& image, const ExrLayout& layout = {});

// Chroma is not subsampled. With `inks` the 4 channels are C M Y K.
File encode_jpeg(const Image8& image, int quality = 100, bool progressive = false, bool inks = false);

// A PNG from its parts, with right checksums and stored (not compressed) data, so that each part can be wrong
// by itself.
struct PngHeader {
  std::uint32_t width, height;
  std::uint8_t bit_depth, colour_type, interlaced = 0;
};
File png_chunk(const std::string& type, const File& data);
File png_signature();
File png_ihdr(const PngHeader& header);
File png_idat(const File& rows);  // each row is a filter byte 0 and its samples
File operator+(const File& a, const File& b);

}  // namespace intaglio::surface::encoders
