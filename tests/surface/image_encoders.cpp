#include "tests/surface/image_encoders.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPreviewImage.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace intaglio::surface::encoders {

namespace {

class Memory : public Imf::OStream {
 public:
  explicit Memory(File& file) : OStream("memory"), file_(file) {}
  void write(const char bytes[], int count) override {
    const std::size_t end = at_ + std::size_t(count);
    if (file_.size() < end) file_.resize(end);
    std::memcpy(file_.data() + at_, bytes, std::size_t(count));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }

 private:
  File& file_;
  std::size_t at_ = 0;
};

File big_endian(std::uint32_t value) {
  return {std::uint8_t(value >> 24), std::uint8_t(value >> 16), std::uint8_t(value >> 8),
          std::uint8_t(value)};
}

std::uint32_t crc(const File& bytes) {
  std::uint32_t sum = 0xffffffff;
  for (const std::uint8_t byte : bytes) {
    sum ^= byte;
    for (int k = 0; k < 8; ++k) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0);
  }
  return ~sum;
}

// The pixels in the order of the file, each as its bytes.
std::vector<File> tga_pixels(const Image8& image, const TgaLayout& layout) {
  std::vector<File> pixels;
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const int x = layout.right_to_left ? image.width - 1 - i : i;
      const int y = layout.top_down ? j : image.height - 1 - j;
      File pixel;
      for (int c = 0; c < image.channels; ++c) pixel.push_back(image.at(x, y, c));
      if (image.channels > 1) std::swap(pixel[0], pixel[2]);
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

File packets(const std::vector<File>& pixels) {
  File file;
  std::size_t k = 0;
  const auto repeats = [&](std::size_t at) {
    std::size_t n = 1;
    while (n < 128 && at + n < pixels.size() && pixels[at + n] == pixels[at]) ++n;
    return n;
  };
  while (k < pixels.size()) {
    std::size_t count = repeats(k);
    const bool run = count > 1;
    while (!run && count < 128 && k + count < pixels.size() && repeats(k + count) == 1) ++count;
    file.push_back(std::uint8_t((count - 1) | (run ? 0x80 : 0)));
    for (std::size_t n = 0; n < (run ? 1 : count); ++n) file = file + pixels[k + n];
    k += count;
  }
  return file;
}

}  // namespace

File operator+(const File& a, const File& b) {
  File both;
  both.reserve(a.size() + b.size());
  both.insert(both.end(), a.begin(), a.end());
  both.insert(both.end(), b.begin(), b.end());
  return both;
}

File encode_tga(const Image8& image, const TgaLayout& layout) {
  const int type = (image.channels == 1 ? 3 : 2) + (layout.run_length ? 8 : 0);
  const int alpha = image.channels == 4 ? layout.alpha_bits : 0;
  const int descriptor = alpha | (layout.right_to_left ? 0x10 : 0) | (layout.top_down ? 0x20 : 0);
  const auto byte = [](int value) { return std::uint8_t(value); };
  File file{byte(int(layout.id.size())), 0, byte(type), 0, 0, 0, 0, 0, 0, 0, 0, 0};
  for (const int value :
       {image.width, image.width >> 8, image.height, image.height >> 8, 8 * image.channels, descriptor}) {
    file.push_back(byte(value));
  }
  file = file + File(layout.id.begin(), layout.id.end());
  const std::vector<File> pixels = tga_pixels(image, layout);
  if (layout.run_length) return file + packets(pixels);
  for (const File& pixel : pixels) file = file + pixel;
  return file;
}

File encode_exr(const Image<float>& image, const ExrLayout& layout) {
  const Imath::Box2i window({layout.left, layout.top},
                            {layout.left + image.width - 1, layout.top + image.height - 1});
  Imf::Header header(Imath::Box2i({0, 0}, {99, 99}), window);
  header.compression() = layout.compression;
  if (layout.preview) header.setPreviewImage(Imf::PreviewImage(4, 4));
  std::vector<std::string> names = layout.channels;
  if (names.empty())
    names =
        image.channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B", "A"};
  const Imf::PixelType type = layout.half ? Imf::HALF : Imf::FLOAT;
  const std::vector<half> halves(image.data.begin(), image.data.end());
  const std::size_t sample = layout.half ? sizeof(half) : sizeof(float);
  const char* const first = layout.half ? reinterpret_cast<const char*>(halves.data())
                                        : reinterpret_cast<const char*>(image.data.data());
  const std::size_t pixel = sample * std::size_t(image.channels);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < std::size_t(image.channels); ++c) {
    header.channels().insert(names[c], Imf::Channel(type));
    buffer.insert(names[c], Imf::Slice::Make(type, first + c * sample, window, pixel,
                                             pixel * std::size_t(image.width)));
  }
  File file;
  Memory memory(file);
  if (layout.tiled) {
    header.setTileDescription(Imf::TileDescription(16, 8, Imf::ONE_LEVEL));
    Imf::TiledOutputFile out(memory, header, 0);
    out.setFrameBuffer(buffer);
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
  } else {
    Imf::OutputFile out(memory, header, 0);
    out.setFrameBuffer(buffer);
    out.writePixels(image.height);
  }
  return file;
}

File encode_jpeg(const Image8& image, int quality, bool progressive, bool inks) {
  const tjhandle encoder = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int format = inks                  ? TJPF_CMYK
                     : image.channels == 1 ? TJPF_GRAY
                     : image.channels == 3 ? TJPF_RGB
                                           : TJPF_RGBA;
  const int status = tjCompress2(encoder, image.data.data(), image.width, 0, image.height, format, &bytes,
                                 &size, image.channels == 1 ? TJSAMP_GRAY : TJSAMP_444, quality,
                                 progressive ? TJFLAG_PROGRESSIVE : 0);
  tjDestroy(encoder);
  if (status != 0) throw std::runtime_error("JPEG encoding failed");
  File file(bytes, bytes + size);
  tjFree(bytes);
  return file;
}

File png_signature() {
  return {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
}

File png_chunk(const std::string& type, const File& data) {
  const File summed = File(type.begin(), type.end()) + data;
  return big_endian(std::uint32_t(data.size())) + summed + big_endian(crc(summed));
}

File png_ihdr(const PngHeader& h) {
  return png_chunk("IHDR", big_endian(h.width) + big_endian(h.height) +
                               File{h.bit_depth, h.colour_type, 0, 0, h.interlaced});
}

File png_idat(const File& rows) {
  std::uint32_t a = 1, b = 0;  // Adler-32
  for (const std::uint8_t byte : rows) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  const auto n = std::uint32_t(rows.size());  // one stored block holds up to 65535 bytes
  const File block{1, std::uint8_t(n), std::uint8_t(n >> 8), std::uint8_t(~n), std::uint8_t(~n >> 8)};
  return png_chunk("IDAT", File{0x78, 0x01} + block + rows + big_endian(b << 16 | a));
}

}  // namespace intaglio::surface::encoders
