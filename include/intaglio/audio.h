// Sound cards and sound files.
//
//   auto card = intaglio::AudioOutput::open({.sample_rate = 48000}).value();
//   auto live = intaglio::LiveSound::create({.sample_rate = double(card.sample_rate())}, bodies).value();
//   if (auto started = card.start(live); !started) ...          // examples/live_sound.cpp
//
// The card calls render() from one of the system's real-time threads until stop(). Call the other functions
// from one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/sound.h"

namespace intaglio {

struct AudioOptions {
  // "default": the system's card, or a silent output if there is none. "null": a silent output that runs in
  // real time. Otherwise a part of a name that audio_outputs() lists.
  std::string device = "default";
  int sample_rate = 44'100;  // Hz
  int buffer_frames = 256;   // wanted; the card may choose another size
};

struct AudioStatus {
  std::uint64_t buffers = 0;    // rendered
  std::uint64_t underruns = 0;  // buffers that came too late, as far as the card can tell
  double latency = 0;           // s, from render() to the speaker
  double peak_load = 0;         // the longest render(), as a fraction of a buffer's duration
  std::string error;            // why it stopped by itself; usually empty
};

class AudioOutput {
 public:
  // Errors: a card that is not there or cannot be opened.
  static Result<AudioOutput> open(const AudioOptions& options = {});
  AudioOutput(AudioOutput&&) noexcept;
  AudioOutput& operator=(AudioOutput&&) noexcept;
  ~AudioOutput();  // stops

  std::string name() const;
  std::string note() const;  // why it is not the device that was asked for; empty when it is
  int sample_rate() const;   // Hz, as it really is
  int buffer_frames() const;

  // `sound` must outlive the playback. Your own callback fills interleaved left and right, -1..1, without
  // allocation, lock or exception. Errors: it is already playing; the system refuses.
  Result<void> start(LiveSound& sound);
  Result<void> start(std::function<void(std::span<float> stereo)> render);
  void stop();  // nothing renders when it returns
  AudioStatus status() const;

 private:
  struct Impl;
  explicit AudioOutput(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// "system: name" of each card that can play.
std::vector<std::string> audio_outputs();

enum class WavFormat { pcm_16, pcm_24, float_32 };

// Writes interleaved samples in -1..1, whole or not at all, and creates missing folders. PCM clips what lies
// outside. Equal samples give equal files. Errors: samples.size() is not a multiple of `channels`; a place
// that cannot be written.
Result<void> write_wav(const std::filesystem::path& path, std::span<const float> samples, int sample_rate,
                       int channels = 1, WavFormat format = WavFormat::pcm_24);

}  // namespace intaglio
