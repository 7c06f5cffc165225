#include "sound/audio/devices.h"

#include <fcntl.h>
#include <rtaudio/RtAudio.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <fmt/format.h>

#include "sound/audio_device.h"

namespace intaglio::sound {

Result<OpenedDevice> open_audio_device(const AudioRequest& request) {
  if (request.sample_rate < 8000 || request.sample_rate > 192'000)
    return fail("sound", fmt::format("a sample rate of {} Hz", request.sample_rate), "44100 is usual");
  if (request.buffer_frames < 16 || request.buffer_frames > 8192)
    return fail("sound", fmt::format("a buffer of {} frames", request.buffer_frames), "give 16 to 8192");
  const auto null = [&] { return std::make_unique<NullDevice>(request.sample_rate, request.buffer_frames); };
  if (request.device == "null") return OpenedDevice{null(), ""};
  const bool is_default = request.device == "default";
  auto card = open_sound_card(is_default ? "" : request.device, request.sample_rate, request.buffer_frames);
  if (card) return OpenedDevice{std::move(*card), ""};
  if (!is_default) return tl::unexpected(card.error());
  return OpenedDevice{null(), card.error().what + "; playing to the null device"};
}

NullDevice::NullDevice(int sample_rate, int buffer_frames)
    : sample_rate_(sample_rate), buffer_frames_(buffer_frames), buffer_(2 * std::size_t(buffer_frames)) {}

Result<void> NullDevice::start(AudioSource& source) {
  if (thread_.joinable()) return fail("null audio device", "is playing already");
  is_stopping_ = false;
  thread_ = std::thread([this, &source] { play(source); });
  return {};
}

void NullDevice::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void NullDevice::play(AudioSource& source) {
  using Clock = std::chrono::steady_clock;
  const auto period = std::chrono::nanoseconds(std::int64_t{1'000'000'000} * buffer_frames_ / sample_rate_);
  auto due = Clock::now();
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    lock.unlock();
    const auto late = Clock::now() - due;
    if (late > period) {
      meter_.count_underruns(static_cast<std::uint64_t>(late / period));
      due += late / period * period;
    }
    meter_.render(source, buffer_, sample_rate_);
    due += period;
    lock.lock();
    wake_.wait_until(lock, due, [this] { return is_stopping_; });
  }
}

namespace {

constexpr std::array systems{RtAudio::LINUX_PULSE, RtAudio::LINUX_ALSA, RtAudio::UNIX_JACK};

// ALSA and JACK report every device that is not there to standard error, and ask no one.
class QuietStandardError {
 public:
  QuietStandardError() : saved_(dup(STDERR_FILENO)) {
    std::fflush(stderr);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) close(nowhere);
  }
  ~QuietStandardError() {
    std::fflush(stderr);
    if (saved_ >= 0) dup2(saved_, STDERR_FILENO);
    if (saved_ >= 0) close(saved_);
  }
  QuietStandardError(const QuietStandardError&) = delete;
  QuietStandardError& operator=(const QuietStandardError&) = delete;

 private:
  int saved_;
};

// Calls visit(RtAudio&, device number, DeviceInfo) for every device that can play, until it returns true.
template <class Visit>
void visit_cards(const Visit& visit) {
  for (const RtAudio::Api system : systems) {
    try {
      auto audio = std::make_unique<RtAudio>(system);
      audio->showWarnings(false);
      if (audio->getCurrentApi() != system) continue;
      const unsigned count = audio->getDeviceCount();
      for (unsigned k = 0; k < count; ++k) {
        const RtAudio::DeviceInfo info = audio->getDeviceInfo(k);
        if (info.probed && info.outputChannels > 0 && visit(audio, k, info)) return;
      }
    } catch (const RtAudioError&) {
      // A system that is not there, or a card that went away meanwhile: the next one.
    }
  }
}

std::string full_name(RtAudio& audio, const RtAudio::DeviceInfo& info) {
  return RtAudio::getApiName(audio.getCurrentApi()) + ": " + info.name;
}

class RtAudioDevice : public AudioDevice {
 public:
  RtAudioDevice(std::unique_ptr<RtAudio> audio, unsigned device, std::string name)
      : audio_(std::move(audio)), device_(device), name_(std::move(name)) {}
  ~RtAudioDevice() override { stop(); }

  Result<void> open(int sample_rate, int buffer_frames) {
    RtAudio::StreamParameters output;
    output.deviceId = device_;
    output.nChannels = 2;
    RtAudio::StreamOptions options;
    options.flags = RTAUDIO_MINIMIZE_LATENCY | RTAUDIO_SCHEDULE_REALTIME;
    options.numberOfBuffers = 2;
    options.streamName = "intaglio";
    auto frames = static_cast<unsigned>(buffer_frames);
    try {
      audio_->openStream(&output, nullptr, RTAUDIO_FLOAT32, static_cast<unsigned>(sample_rate), &frames,
                         &pull, this, &options, [](RtAudioError::Type, const std::string&) {});
      buffer_frames_ = static_cast<int>(frames);
      sample_rate_ = static_cast<int>(audio_->getStreamSampleRate());
      buffers_ = std::max(1u, options.numberOfBuffers);
    } catch (const RtAudioError& error) {
      return fail(name_, "cannot be opened: " + error.getMessage(),
                  "is another program using it? `intaglio sound devices` lists the others");
    }
    return {};
  }

  std::string name() const override { return name_; }
  int sample_rate() const override { return sample_rate_; }
  int buffer_frames() const override { return buffer_frames_; }

  Result<void> start(AudioSource& source) override {
    if (source_) return fail(name_, "is playing already");
    source_ = &source;
    try {
      audio_->startStream();
      const long latency = audio_->getStreamLatency();
      const double frames = latency > 0 ? double(latency) : double(buffers_) * buffer_frames_;
      latency_ = frames / sample_rate_;
    } catch (const RtAudioError& error) {
      source_ = nullptr;
      return fail(name_, "cannot be started: " + error.getMessage());
    }
    return {};
  }
  void stop() override {
    try {
      if (audio_->isStreamRunning()) audio_->stopStream();
    } catch (const RtAudioError&) {
      // It has stopped by itself.
    }
    source_ = nullptr;
  }
  AudioStatus status() const override {
    AudioStatus status = meter_.status(latency_);
    if (source_ && !audio_->isStreamRunning()) status.error = name_ + " has stopped";
    return status;
  }

 private:
  static int pull(void* out, void*, unsigned frames, double, RtAudioStreamStatus status, void* self) {
    auto& device = *static_cast<RtAudioDevice*>(self);
    if ((status & RTAUDIO_OUTPUT_UNDERFLOW) != 0) device.meter_.count_underruns(1);
    const std::span<float> stereo(static_cast<float*>(out), 2 * std::size_t(frames));
    device.meter_.render(*device.source_, stereo, device.sample_rate_);
    return 0;
  }

  std::unique_ptr<RtAudio> audio_;
  unsigned device_;
  std::string name_;
  int sample_rate_ = 0, buffer_frames_ = 0;
  unsigned buffers_ = 1;
  AudioSource* source_ = nullptr;
  std::atomic<double> latency_{0};
  RenderMeter meter_;
};

}  // namespace

std::vector<SoundCard> sound_cards() {
  const QuietStandardError quiet;
  std::vector<SoundCard> cards;
  visit_cards([&](std::unique_ptr<RtAudio>& audio, unsigned, const RtAudio::DeviceInfo& info) {
    cards.push_back({RtAudio::getApiName(audio->getCurrentApi()), info.name, int(info.outputChannels),
                     info.isDefaultOutput, std::vector<int>(info.sampleRates.begin(), info.sampleRates.end()),
                     int(info.preferredSampleRate)});
    return false;
  });
  return cards;
}

Result<std::unique_ptr<AudioDevice>> open_sound_card(const std::string& name, int sample_rate,
                                                     int buffer_frames) {
  const QuietStandardError quiet;
  std::unique_ptr<RtAudioDevice> device;
  int seen = 0;
  visit_cards([&](std::unique_ptr<RtAudio>& audio, unsigned k, const RtAudio::DeviceInfo& info) {
    ++seen;
    const std::string full = full_name(*audio, info);
    const bool is_wanted = name.empty() ? info.isDefaultOutput : full.find(name) != std::string::npos;
    if (!is_wanted || info.outputChannels < 2) return false;
    device = std::make_unique<RtAudioDevice>(std::move(audio), k, full);
    return true;
  });
  if (!device) {
    if (seen == 0) {
      return fail("sound", "no audio device on this machine",
                  "\"null\" plays to nobody, in real time; a WAV file needs no device");
    }
    const std::string what =
        name.empty() ? "no default audio device" : fmt::format("no audio device \"{}\"", name);
    return fail("sound", what, "`intaglio sound devices` lists what there is");
  }
  if (auto opened = device->open(sample_rate, buffer_frames); !opened) return tl::unexpected(opened.error());
  return std::unique_ptr<AudioDevice>(std::move(device));
}

}  // namespace intaglio::sound
