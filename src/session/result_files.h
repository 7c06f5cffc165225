// Writes a session's sound and logs while it runs: `.wav`, `.events.csv` and `.servo.csv` of a set of files.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/file_stream.h"
#include "core/output_files.h"
#include "haptics/haptic_log.h"
#include "session/recording.h"
#include "sound/audio/wav.h"

namespace intaglio::session {

class ResultFiles : public Observer {
 public:
  // Beside `output`, with its name and other extensions; `files` lives longer.
  static Result<std::unique_ptr<ResultFiles>> create(OutputFiles& files, const std::filesystem::path& output,
                                                     const Run& run);

  void on_event(const ContactEvent& event) override { events_.write(event_row(event)); }
  void on_tick(const haptics::ServoSample& sample) override { log_.add(sample); }
  void on_sound(std::span<const float> stereo) override;

  // The first error of a file, as early as it is known.
  Result<void> check() const;
  // Ends all three files.
  Result<void> finish();
  // The sound's temporary, whole after finish().
  const std::filesystem::path& wav() const { return wav_file_; }

 private:
  ResultFiles(std::filesystem::path wav_file, sound::WavWriter wav, FileStream events, FileStream servo,
              const Run& run);

  std::filesystem::path wav_file_;
  sound::WavWriter wav_;
  std::vector<float> pending_;  // sound that is not written yet: libsndfile writes what it is given at once
  FileStream events_, servo_;
  haptics::LogEncoder log_;
};

}  // namespace intaglio::session
