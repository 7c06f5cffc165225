// WAV files, and MP3 for web pages: samples in -1..1 (full scale; see synthesizer.h), of one channel or
// interleaved.
#pragma once

#include <filesystem>
#include <span>

#include "intaglio/error.h"

namespace intaglio::sound {

enum class WavFormat { pcm_16, pcm_24, float_32, mp3 };

struct WavOptions {
  WavFormat format = WavFormat::pcm_24;
  int channels = 1;
};

// Writes all of `samples` or nothing: into a temporary beside `path`, renamed when complete. Creates the
// folder. PCM clips what lies outside -1..1. The file depends on the arguments only, so equal sounds are
// equal files.
Result<void> write_wav(const std::filesystem::path& path, std::span<const float> samples, int sample_rate,
                       const WavOptions& options = {});

}  // namespace intaglio::sound
