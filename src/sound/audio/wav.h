// WAV files, and MP3 for web pages, from samples in -1..1 (full scale; see synthesizer.h), mono or
// interleaved.
#pragma once

#include <filesystem>
#include <span>

#include "core/output_files.h"
#include "intaglio/error.h"

namespace intaglio::sound {

enum class WavFormat { pcm_16, pcm_24, float_32, mp3 };

struct WavOptions {
  WavFormat format = WavFormat::pcm_24;
  int channels = 1;
};

// Writes all or nothing (core/output_files.h) and creates the folder. PCM clips samples outside -1..1. The
// file depends only on the arguments, so equal sounds give equal files.
Result<void> write_wav(const std::filesystem::path& path, std::span<const float> samples, int sample_rate,
                       const WavOptions& options = {});

// The same as one file of a set; returns the temporary, for programs that read it before commit().
Result<std::filesystem::path> add_wav(OutputFiles& files, const std::filesystem::path& path,
                                      std::span<const float> samples, int sample_rate,
                                      const WavOptions& options = {});

// Writes to a temporary of a set. An error names `path`.
Result<void> fill_wav(const std::filesystem::path& temporary, const std::filesystem::path& path,
                      std::span<const float> samples, int sample_rate, const WavOptions& options = {});

}  // namespace intaglio::sound
