// Encodes frames and sound into an MP4 (H.264 and AAC), by ffmpeg through a socket.
//
// Two passes, so that frames are encoded while the sound is still being made: frames go into a video without
// sound, which finish() muxes with the sound. Both are temporaries of the caller's set of files, whose commit
// puts the MP4 in place; the set lives longer than the writer. One thread at a time.
//
// A recoverable video is kept in fragments of a quarter of a second, so that recover_videos() can put it
// together when its process was killed. The encoder holds back half a second more.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/output_files.h"
#include "core/process.h"
#include "intaglio/error.h"
#include "intaglio/image.h"

namespace intaglio::session {

// The ffmpeg program on PATH, or an error that says how to install it.
Result<std::filesystem::path> find_ffmpeg();

struct VideoFormat {
  int width = 640, height = 360;  // pixels, even
  int fps = 30;                   // frames per second
  int sound_rate = 0;             // Hz: the sound comes with the frames, and the video is recoverable
};

class VideoWriter {
 public:
  // Adds `target` to the set and starts the encoder.
  static Result<std::unique_ptr<VideoWriter>> create(OutputFiles& files, const std::filesystem::path& target,
                                                     const VideoFormat& format);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  Result<void> add(const Image8& frame);
  // Appends to the sound of a recoverable video: left and right interleaved.
  Result<void> add_sound(std::span<const float> stereo);
  // Muxes the frames with the sound that came with them, trimmed or padded with silence to their length;
  // returns the MP4's temporary.
  Result<std::filesystem::path> finish();
  // The same with the sound of a WAV file, which may be a temporary of the set.
  Result<std::filesystem::path> finish(const std::filesystem::path& wav);
  // The same with samples.
  Result<std::filesystem::path> finish(std::span<const float> stereo, int sample_rate);

 private:
  VideoWriter(OutputFiles& files, const VideoFormat& format) : files_(files), format_(format) {}

  Result<std::filesystem::path> finish(const std::filesystem::path& sound, int raw_rate);

  OutputFiles& files_;
  VideoFormat format_;
  std::filesystem::path ffmpeg_, target_, video_only_, sound_, muxed_;
  int socket_ = -1;
  std::optional<Process> encoder_;
};

struct RecoveredVideo {
  std::filesystem::path file;
  double seconds = 0;
};

// Puts together the recoverable videos that killed processes left in a folder, each under the name that it
// was to get, and removes their temporaries and all other stale ones there. A video that cannot be put
// together is an error, and its temporaries stay. Takes as long as copying the files.
std::vector<Result<RecoveredVideo>> recover_videos(const std::filesystem::path& folder);

}  // namespace intaglio::session
