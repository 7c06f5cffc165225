// Chooses an audio device by name.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "sound/audio_device.h"

namespace intaglio::sound {

struct AudioRequest {
  // "default": the system's, or the null device, with a note, where there is none. "null": nobody hears it.
  // Else a part of a name that `intaglio sound devices` lists; such a one that is missing is an error.
  std::string device = "default";
  int sample_rate = 44'100;  // Hz
  int buffer_frames = 256;   // 5.8 ms
};

struct OpenedDevice {
  std::unique_ptr<AudioDevice> device;
  std::string note;  // why it is not what was hoped for; empty when all is well
};

Result<OpenedDevice> open_audio_device(const AudioRequest& request = {});

// An audio device that plays to nobody, in real time: for machines without a sound card, and for measuring.
//
// A thread renders a buffer each buffer's time, by the steady clock. A buffer that is begun more than its own
// time late counts as an underrun; the clock goes on from there.

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
  std::mutex mutex_;  // of is_stopping_; not held while rendering
  std::condition_variable wake_;
  bool is_stopping_ = false;
  std::thread thread_;
};

// The sound cards of this machine, through RtAudio: PulseAudio or PipeWire, ALSA, JACK, in that order.
//
// Opening and listing take milliseconds and may print nothing: what the systems below say on standard error
// meanwhile is swallowed (process-wide, so do it before other threads report errors there). The device may
// choose another buffer size than asked for. render() runs in the system's audio thread, with real-time
// scheduling where the user may have it.

struct SoundCard {
  std::string system;  // "pulse", "alsa", "jack"
  std::string name;
  int channels = 0;
  bool is_default = false;
  std::vector<int> sample_rates;  // Hz
  int preferred_rate = 0;         // Hz, 0: unknown
};

// All that can play.
std::vector<SoundCard> sound_cards();

// Opens the first card whose "system: name" contains `name`, the default one when that is empty.
Result<std::unique_ptr<AudioDevice>> open_sound_card(const std::string& name, int sample_rate,
                                                     int buffer_frames);

}  // namespace intaglio::sound
