// WAV files, and MP3 for web pages, from samples in -1..1 (full scale; see synthesizer.h), mono or
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

// Atomic: writes a temporary file beside `path`, then renames it. Creates the folder. PCM clips samples
// outside -1..1. The file depends only on the arguments, so equal sounds give equal files.
Result<void> write_wav(const std::filesystem::path& path, std::span<const float> samples, int sample_rate,
                       const WavOptions& options = {});

}  // namespace intaglio::sound
