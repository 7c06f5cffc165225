#include <utility>

#include "intaglio/audio.h"
#include "sound/api.h"
#include "sound/audio/devices.h"
#include "sound/audio/wav.h"

namespace intaglio {

namespace {

class Callback : public sound::AudioSource {
 public:
  explicit Callback(std::function<void(std::span<float>)> render) : render_(std::move(render)) {}
  void render(std::span<float> stereo) noexcept override { render_(stereo); }

 private:
  std::function<void(std::span<float>)> render_;
};

}  // namespace

struct AudioOutput::Impl {
  sound::OpenedDevice opened;
  std::unique_ptr<Callback> callback = nullptr;

  ~Impl() { opened.device->stop(); }
};

AudioOutput::AudioOutput(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AudioOutput::AudioOutput(AudioOutput&&) noexcept = default;
AudioOutput& AudioOutput::operator=(AudioOutput&&) noexcept = default;
AudioOutput::~AudioOutput() = default;

Result<AudioOutput> AudioOutput::open(const AudioOptions& options) {
  auto opened = sound::open_audio_device({options.device, options.sample_rate, options.buffer_frames});
  if (!opened) return tl::unexpected(opened.error());
  return AudioOutput(std::unique_ptr<Impl>(new Impl{std::move(*opened)}));
}

std::string AudioOutput::name() const {
  return impl_->opened.device->name();
}
std::string AudioOutput::note() const {
  return impl_->opened.note;
}
int AudioOutput::sample_rate() const {
  return impl_->opened.device->sample_rate();
}
int AudioOutput::buffer_frames() const {
  return impl_->opened.device->buffer_frames();
}

Result<void> AudioOutput::start(LiveSound& sound) {
  return impl_->opened.device->start(sound.impl().sound);
}
Result<void> AudioOutput::start(std::function<void(std::span<float> stereo)> render) {
  auto callback = std::make_unique<Callback>(std::move(render));
  auto started = impl_->opened.device->start(*callback);
  if (started) impl_->callback = std::move(callback);
  return started;
}
void AudioOutput::stop() {
  impl_->opened.device->stop();
}
AudioStatus AudioOutput::status() const {
  const sound::AudioStatus from = impl_->opened.device->status();
  return {from.buffers, from.underruns, from.latency, from.busiest, from.error};
}

std::vector<std::string> audio_outputs() {
  std::vector<std::string> names;
  for (const sound::SoundCard& card : sound::sound_cards()) names.push_back(card.system + ": " + card.name);
  return names;
}

Result<void> write_wav(const std::filesystem::path& path, std::span<const float> samples, int sample_rate,
                       int channels, WavFormat format) {
  const auto as = format == WavFormat::pcm_16   ? sound::WavFormat::pcm_16
                  : format == WavFormat::pcm_24 ? sound::WavFormat::pcm_24
                                                : sound::WavFormat::float_32;
  return sound::write_wav(path, samples, sample_rate, {as, channels});
}

}  // namespace intaglio
