#include "sound/audio/wav.h"

#include <sndfile.h>

#include <memory>
#include <system_error>
#include <fmt/format.h>

#include "core/file.h"

namespace intaglio::sound {

namespace fs = std::filesystem;

namespace {

int file_format(WavFormat format) {
  switch (format) {
    case WavFormat::pcm_16:
      return SF_FORMAT_WAV | SF_FORMAT_PCM_16;
    case WavFormat::pcm_24:
      return SF_FORMAT_WAV | SF_FORMAT_PCM_24;
    case WavFormat::float_32:
      return SF_FORMAT_WAV | SF_FORMAT_FLOAT;
    case WavFormat::mp3:
      return SF_FORMAT_MPEG | SF_FORMAT_MPEG_LAYER_III;
  }
  return SF_FORMAT_WAV | SF_FORMAT_PCM_24;
}

// What went wrong, or nothing.
std::string write_all(const fs::path& temporary, std::span<const float> samples, SF_INFO info) {
  SNDFILE* const file = sf_open(temporary.c_str(), SFM_WRITE, &info);
  if (!file) return sf_strerror(nullptr);
  sf_command(file, SFC_SET_CLIPPING, nullptr, SF_TRUE);
  // A float file otherwise carries the time of its making in a PEAK chunk.
  sf_command(file, SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
  double compression = 0.7;  // of MP3 only: about 60 kbit/s a channel
  sf_command(file, SFC_SET_COMPRESSION_LEVEL, &compression, sizeof compression);
  const auto count = static_cast<sf_count_t>(samples.size()) / info.channels;
  std::string reason;
  if (sf_writef_float(file, samples.data(), count) != count) reason = sf_strerror(file);
  const int closed = sf_close(file);  // a full disk is often noticed only here
  if (reason.empty() && closed != 0) reason = sf_error_number(closed);
  return reason;
}

}  // namespace

Result<void> write_wav(const fs::path& path, std::span<const float> samples, int sample_rate,
                       const WavOptions& options) {
  if (auto writable = check_writable(path); !writable) return writable;
  if (sample_rate <= 0)
    return fail(path.string(), fmt::format("a sample rate of {} Hz", sample_rate), "44100 is usual");
  SF_INFO info{};
  info.channels = options.channels;
  info.samplerate = sample_rate;
  info.format = file_format(options.format);
  const auto made = temporary_for(path);
  if (!made) return tl::unexpected(made.error());
  const fs::path& temporary = *made;
  std::error_code error;
  if (const std::string reason = write_all(temporary, samples, info); !reason.empty()) {
    fs::remove(temporary, error);
    return fail(path.string(), "writing failed: " + reason, "is the disk full?");
  }
  fs::rename(temporary, path, error);
  if (error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return fail(path.string(), "cannot be replaced: " + error.message());
  }
  return {};
}

}  // namespace intaglio::sound
