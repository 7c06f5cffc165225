#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <stdexcept>

#include "intaglio/surface/image_exr_header.h"

namespace intaglio::surface {

namespace {

// A file in memory, whose header is replaced by the one that OpenEXR shall see; the two are equally long.
class Stream : public Imf::IStream {
 public:
  Stream(Bytes bytes, Bytes header, const std::string& name)
      : IStream(name.c_str()), bytes_(bytes), header_(header) {}

  bool read(char to[], int count) override {
    const std::uint64_t end = at_ + static_cast<std::uint64_t>(std::max(count, 0));
    if (count < 0 || at_ > bytes_.size() || end > bytes_.size()) {
      at_ = bytes_.size();
      throw std::runtime_error("the file ends here");
    }
    for (; at_ < std::min<std::uint64_t>(end, header_.size()); ++at_) *to++ = static_cast<char>(header_[at_]);
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

// The file's channels that are read, in the order of the image's: R G B (A), Y (A) or the only one.
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

// Where channel k of `count` chosen ones goes: Y A is made into R G B A.
int component(std::size_t k, std::size_t count) {
  return count == 2 && k == 1 ? 3 : static_cast<int>(k);
}

Imf::FrameBuffer frame_buffer(const ExrHeader& header, const std::vector<ExrChannel>& chosen,
                              Image<float>& image) {
  const Imath::Box2i window({header.left, header.top},
                            {header.left + (header.width - 1), header.top + (header.height - 1)});
  const std::size_t pixel = std::size_t(image.channels) * sizeof(float);
  Imf::FrameBuffer buffer;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    float* const first = &image.at(0, 0, component(k, chosen.size()));
    buffer.insert(chosen[k].name,
                  Imf::Slice::Make(Imf::FLOAT, first, window, pixel, pixel * std::size_t(image.width)));
  }
  return buffer;
}

Result<void> check_finite(const Image<float>& image, const std::string& name) {
  const auto bad =
      std::find_if(image.data.begin(), image.data.end(), [](float v) { return !std::isfinite(v); });
  if (bad == image.data.end()) return {};
  const auto pixel = static_cast<std::size_t>(bad - image.data.begin()) / std::size_t(image.channels);
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

Result<DecodedImage> decode_exr(Bytes bytes, const std::string& name, const ImageLimits& limits) {
  if (!is_exr(bytes)) return fail_at(name, 0, "not an EXR", "save it again");
  const auto header = read_exr_header(bytes, name, limits);
  if (!header) return tl::unexpected(header.error());
  const auto chosen = choose_channels(*header, name);
  if (!chosen) return tl::unexpected(chosen.error());
  const auto any = [&](ExrSample sample) {
    return std::any_of(chosen->begin(), chosen->end(),
                       [&](const ExrChannel& c) { return c.sample == sample; });
  };
  if (any(ExrSample::whole_number)) {
    return fail_at(name, header->channels_at, "an EXR of whole numbers", "save it as half or float");
  }

  const int channels = chosen->size() == 2 ? 4 : static_cast<int>(chosen->size());
  DecodedImage out{Image<float>(header->width, header->height, channels), any(ExrSample::single) ? 32 : 16};
  Stream stream(bytes, header->shown, name);
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
