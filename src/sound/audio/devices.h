// Audio output: chooses a device by name, and lists the sound cards.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "sound/audio_device.h"

namespace intaglio::sound {

struct AudioDeviceOptions {
  // "default": the system's, or the null device, with a note, if there is none. "null": discards the sound.
  // Otherwise part of a name that `intaglio sound devices` lists; if there is no such device, that is an
  // error.
  std::string device = "default";
  int sample_rate = 44'100;  // Hz
  int buffer_frames = 256;   // 5.8 ms
};

struct OpenedDevice {
  std::unique_ptr<AudioDevice> device;
  std::string note;  // why the fallback was used, else empty
};

Result<OpenedDevice> open_audio_device(const AudioDeviceOptions& request = {});

// An audio device that discards its samples in real time: for machines without a sound card, and for
// measuring.
//
// A thread renders one buffer per buffer period, by the steady clock. A buffer started more than one period
// late counts as an underrun; the clock goes on from there.

class NullDevice : public AudioDevice {
 public:
  explicit NullDevice(int sample_rate = 44'100, int buffer_frames = 256);
  ~NullDevice() override { stop(); }

  std::string name() const override { return "null"; }
  int sample_rate() const override { return sample_rate_; }
  int buffer_frames() const override { return buffer_frames_; }
  Result<void> start(AudioSource& source) override;
  void stop() override;
  AudioStatus status() const override { return meter_.status(double(buffer_frames_) / sample_rate_); }

 private:
  void play(AudioSource& source);

  int sample_rate_, buffer_frames_;
  std::vector<float> buffer_;
  RenderMeter meter_;
  std::mutex mutex_;  // guards is_stopping_; not held while rendering
  std::condition_variable wake_;
  bool is_stopping_ = false;
  std::thread thread_;
};

// The sound cards of this machine, through RtAudio: PulseAudio or PipeWire, ALSA, JACK, in that order.
//
// Opening and listing take milliseconds and print nothing: the process's standard error is redirected
// meanwhile, one caller at a time, and then restored, so do it before other threads report errors there. The
// device may choose another buffer size than requested. render() runs in the system's audio thread, with
// real-time scheduling where the user may have it.

struct SoundCard {
  std::string api;  // "pulse", "alsa", "jack"
  std::string name;
  int channels = 0;
  bool is_default = false;
  std::vector<int> sample_rates;  // Hz
  int preferred_rate = 0;         // Hz, 0: unknown
};

// All cards with an output.
std::vector<SoundCard> sound_cards();

// Opens the first card whose "api: name" contains `name`, the default one if that is empty.
Result<std::unique_ptr<AudioDevice>> open_sound_card(const std::string& name, int sample_rate,
                                                     int buffer_frames);

// While one lives, what is written to standard error is discarded: ALSA and JACK report there every device
// that does not exist. A second one waits for the first. Does nothing if standard error is closed.
class QuietStandardError {
 public:
  QuietStandardError();
  ~QuietStandardError();
  QuietStandardError(const QuietStandardError&) = delete;
  QuietStandardError& operator=(const QuietStandardError&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  int saved_;  // a copy of the descriptor; -1: nothing was redirected
};

}  // namespace intaglio::sound
