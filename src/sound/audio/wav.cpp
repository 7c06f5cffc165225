#include "sound/audio/wav.h"

#include <sndfile.h>

#include <fmt/format.h>

#include <cerrno>
#include <string>
#include <utility>

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

// libsndfile's own error does not say why the system refused; errno does.
Error sound_error(const fs::path& path, const char* reason) {
  if (errno != 0) return write_error(path, errno);
  return {path.string(), std::string("cannot be written: ") + reason, ""};
}

Result<void> check_channels(const fs::path& path, std::size_t samples, int channels) {
  if (channels >= 1 && samples % std::size_t(channels) == 0) return {};
  return fail(path.string(), fmt::format("{} samples cannot be {} channels", samples, channels),
              "give every channel as many samples as the others");
}

}  // namespace

struct WavWriter::File {
  fs::path path;
  int channels;
  SNDFILE* sound = nullptr;
  std::optional<Error> error = {};

  ~File() {
    if (sound != nullptr) sf_close(sound);
  }
};

WavWriter::WavWriter(std::unique_ptr<File> file) : file_(std::move(file)) {}
WavWriter::WavWriter(WavWriter&&) noexcept = default;
WavWriter::~WavWriter() = default;

Result<WavWriter> WavWriter::create(const fs::path& temporary, const fs::path& path, int sample_rate,
                                    const WavOptions& options) {
  if (sample_rate <= 0)
    return fail(path.string(), fmt::format("sample rate {} Hz is out of range", sample_rate),
                "44100 is usual");
  if (auto checked = check_channels(path, 0, options.channels); !checked)
    return tl::unexpected(checked.error());
  SF_INFO info{};
  info.channels = options.channels;
  info.samplerate = sample_rate;
  info.format = file_format(options.format);
  auto file = std::make_unique<File>(File{path, options.channels});
  errno = 0;
  file->sound = sf_open(temporary.c_str(), SFM_WRITE, &info);
  if (file->sound == nullptr) return tl::unexpected(sound_error(path, sf_strerror(nullptr)));
  sf_command(file->sound, SFC_SET_CLIPPING, nullptr, SF_TRUE);
  // The PEAK chunk of a float file would contain a timestamp.
  sf_command(file->sound, SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
  double compression = 0.7;  // MP3 only: about 60 kbit/s per channel
  sf_command(file->sound, SFC_SET_COMPRESSION_LEVEL, &compression, sizeof compression);
  return WavWriter(std::move(file));
}

void WavWriter::add(std::span<const float> samples) {
  if (file_->error) return;
  const auto count = sf_count_t(samples.size()) / file_->channels;
  errno = 0;
  if (sf_writef_float(file_->sound, samples.data(), count) != count)
    file_->error = sound_error(file_->path, sf_strerror(file_->sound));
}

const std::optional<Error>& WavWriter::error() const {
  return file_->error;
}

Result<void> WavWriter::finish() {
  errno = 0;
  const int closed =
      sf_close(std::exchange(file_->sound, nullptr));  // a full disk is often noticed only here
  if (!file_->error && closed != 0) file_->error = sound_error(file_->path, sf_error_number(closed));
  if (file_->error) return tl::unexpected(*file_->error);
  return {};
}

Result<void> fill_wav(const fs::path& temporary, const fs::path& path, std::span<const float> samples,
                      int sample_rate, const WavOptions& options) {
  if (auto checked = check_channels(path, samples.size(), options.channels); !checked) return checked;
  auto writer = WavWriter::create(temporary, path, sample_rate, options);
  if (!writer) return tl::unexpected(writer.error());
  writer->add(samples);
  return writer->finish();
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
