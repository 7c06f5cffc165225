// Encodes frames and sound into an MP4 (H.264 and AAC), by ffmpeg through a socket.
//
// Two passes, so that frames are encoded while the sound is still being made: frames go into a video without
// sound, which finish() muxes with the sound. Both are temporaries of the caller's set of files, whose commit
// puts the MP4 in place; the set lives longer than the writer. One thread at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "core/output_files.h"
#include "core/process.h"
#include "intaglio/error.h"
#include "intaglio/image.h"

namespace intaglio::session {

// The ffmpeg program on PATH, or an error that says how to install it.
Result<std::filesystem::path> find_ffmpeg();

class VideoWriter {
 public:
  // Adds `target` to the set and starts the encoder for frames of width x height.
  static Result<std::unique_ptr<VideoWriter>> create(OutputFiles& files, const std::filesystem::path& target,
                                                     int width, int height, int fps);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  Result<void> add(const Image8& frame);
  // Muxes the frames with the sound of a WAV file, which may be a temporary of the set; returns the MP4's
  // temporary.
  Result<std::filesystem::path> finish(const std::filesystem::path& wav);
  // The same with samples, left and right interleaved.
  Result<std::filesystem::path> finish(std::span<const float> stereo, int sample_rate);

 private:
  explicit VideoWriter(OutputFiles& files) : files_(files) {}

  OutputFiles& files_;
  std::filesystem::path ffmpeg_, target_, video_only_, muxed_;
  int socket_ = -1;
  std::optional<Process> encoder_;
};

}  // namespace intaglio::session
