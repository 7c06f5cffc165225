// Frames and sound into an MP4 (H.264 and AAC), by ffmpeg through a pipe.
//
// Two passes, so that frames are encoded while the sound is still being made: frames go into a silent
// temporary, finish() joins it with the sound. Temporaries go away whatever happens; the target appears whole
// or not at all. One thread at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/process.h"
#include "intaglio/error.h"
#include "intaglio/image.h"

namespace intaglio::session {

// The ffmpeg program on PATH, or an error that says how to get it.
Result<std::filesystem::path> find_ffmpeg();

class VideoWriter {
 public:
  // Starts the encoder for frames of width x height.
  static Result<std::unique_ptr<VideoWriter>> create(const std::filesystem::path& target, int width,
                                                     int height, int fps);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  Result<void> add(const Image8& frame);
  // Joins the frames with the sound of a WAV file and puts the MP4 in place.
  Result<void> finish(const std::filesystem::path& wav);

 private:
  VideoWriter() = default;

  std::filesystem::path ffmpeg_, target_, silent_, joined_;
  int pipe_ = -1;
  std::optional<Process> encoder_;
};

}  // namespace intaglio::session
