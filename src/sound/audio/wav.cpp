#include "sound/audio/wav.h"

#include <sndfile.h>

#include <fmt/format.h>

#include <cerrno>
#include <string>

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

Result<void> write_all(const fs::path& temporary, const fs::path& path, std::span<const float> samples,
                       SF_INFO info) {
  // libsndfile's own error does not say why the system refused; errno does.
  const auto failed = [&](const char* reason) -> Result<void> {
    if (errno != 0) return tl::unexpected(write_error(path, errno));
    return fail(path.string(), std::string("cannot be written: ") + reason);
  };
  errno = 0;
  SNDFILE* const file = sf_open(temporary.c_str(), SFM_WRITE, &info);
  if (!file) return failed(sf_strerror(nullptr));
  sf_command(file, SFC_SET_CLIPPING, nullptr, SF_TRUE);
  // The PEAK chunk of a float file would contain a timestamp.
  sf_command(file, SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
  double compression = 0.7;  // MP3 only: about 60 kbit/s per channel
  sf_command(file, SFC_SET_COMPRESSION_LEVEL, &compression, sizeof compression);
  const auto count = sf_count_t(samples.size()) / info.channels;
  errno = 0;
  Result<void> written;
  if (sf_writef_float(file, samples.data(), count) != count) written = failed(sf_strerror(file));
  if (written) errno = 0;
  const int closed = sf_close(file);  // a full disk is often noticed only here
  if (written && closed != 0) written = failed(sf_error_number(closed));
  return written;
}

}  // namespace

Result<void> fill_wav(const fs::path& temporary, const fs::path& path, std::span<const float> samples,
                      int sample_rate, const WavOptions& options) {
  if (sample_rate <= 0)
    return fail(path.string(), fmt::format("sample rate {} Hz is out of range", sample_rate),
                "44100 is usual");
  if (options.channels < 1 || samples.size() % std::size_t(options.channels) != 0)
    return fail(path.string(),
                fmt::format("{} samples cannot be {} channels", samples.size(), options.channels),
                "give every channel as many samples as the others");
  SF_INFO info{};
  info.channels = options.channels;
  info.samplerate = sample_rate;
  info.format = file_format(options.format);
  return write_all(temporary, path, samples, info);
}

Result<fs::path> add_wav(OutputFiles& files, const fs::path& path, std::span<const float> samples,
                         int sample_rate, const WavOptions& options) {
  auto temporary = files.add(path);
  if (!temporary) return temporary;
  if (auto filled = fill_wav(*temporary, path, samples, sample_rate, options); !filled)
    return tl::unexpected(filled.error());
  return temporary;
}

Result<void> write_wav(const fs::path& path, std::span<const float> samples, int sample_rate,
                       const WavOptions& options) {
  OutputFiles files;
  if (const auto added = add_wav(files, path, samples, sample_rate, options); !added)
    return tl::unexpected(added.error());
  return files.commit();
}

}  // namespace intaglio::sound
