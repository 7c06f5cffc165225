// Encodes frames and sound into an MP4 (H.264 and AAC), by ffmpeg through a socket.
//
// Two passes, so that frames are encoded while the sound is still being made: frames go into a temporary
// video without sound, which finish() muxes with the sound. Temporaries are always removed; the target
// appears whole or not at all. One thread at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/process.h"
#include "intaglio/error.h"
#include "intaglio/image.h"

namespace intaglio::session {

// The ffmpeg program on PATH, or an error that says how to install it.
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
  // Muxes the frames with the sound of a WAV file and moves the MP4 into place.
  Result<void> finish(const std::filesystem::path& wav);

 private:
  VideoWriter() = default;

  std::filesystem::path ffmpeg_, target_, video_only_, muxed_;
  int socket_ = -1;
  std::optional<Process> encoder_;
};

}  // namespace intaglio::session
