// WAV files, and MP3 for web pages, from samples in -1..1 (full scale; see synthesizer.h), mono or
// interleaved.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "core/output_files.h"
#include "intaglio/error.h"

namespace intaglio::sound {

enum class WavFormat { pcm_16, pcm_24, float_32, mp3 };

struct WavOptions {
  WavFormat format = WavFormat::pcm_24;
  int channels = 1;
};

// Writes samples as they are made, into a temporary of a set; an error names `path`. One thread at a time.
class WavWriter {
 public:
  static Result<WavWriter> create(const std::filesystem::path& temporary, const std::filesystem::path& path,
                                  int sample_rate, const WavOptions& options = {});
  WavWriter(WavWriter&&) noexcept;
  ~WavWriter();

  // Whole frames. The first error is kept, and nothing is written after it.
  void add(std::span<const float> samples);
  const std::optional<Error>& error() const;
  // Completes the header and closes the file. Returns the first error.
  Result<void> finish();

 private:
  struct File;
  explicit WavWriter(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

// Writes all or nothing (core/output_files.h) and creates the folder. PCM clips samples outside -1..1. The
// file depends only on the arguments, so equal sounds give equal files.
Result<void> write_wav(const std::filesystem::path& path, std::span<const float> samples, int sample_rate,
                       const WavOptions& options = {});

// The same as one file of a set; returns the temporary, for programs that read it before commit().
Result<std::filesystem::path> add_wav(OutputFiles& files, const std::filesystem::path& path,
                                      std::span<const float> samples, int sample_rate,
                                      const WavOptions& options = {});

// The same into a temporary of a set. An error names `path`.
Result<void> fill_wav(const std::filesystem::path& temporary, const std::filesystem::path& path,
                      std::span<const float> samples, int sample_rate, const WavOptions& options = {});

}  // namespace intaglio::sound
