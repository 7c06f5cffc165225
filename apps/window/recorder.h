// Records the window's pictures and sound into an MP4: frames at a fixed rate whatever the window's is, sound
// in stereo as it is played. A thread of its own and ffmpeg encode; when their queue is full, the previous
// frame is repeated, so that the window never waits.
//
// The video appears when recording stops. Until then picture and sound are in hidden temporaries, from which
// the next start puts together what a killed window had recorded (session::recover_videos). Memory does not
// grow with time.
//
// One thread (the window's). When the disk is full or ffmpeg dies, add() returns the error and recording
// stops.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <queue>
#include <span>
#include <thread>
#include <vector>

#include "session/video.h"

namespace intaglio::window {

class Recorder {
 public:
  static Result<std::unique_ptr<Recorder>> start(const std::filesystem::path& target, int width, int height,
                                                 int fps, int sample_rate);
  ~Recorder();

  const std::filesystem::path& target() const { return target_; }
  int width() const { return width_; }
  int height() const { return height_; }
  // Whether a frame is due at `time`, seconds since the start.
  bool is_frame_due(double time) const { return std::int64_t(time * fps_) >= frames_; }
  Result<void> add(const Image8& frame, double time);
  void add_audio(std::span<const float> stereo);
  double seconds() const { return double(frames_) / fps_; }

  // Joins picture and sound and puts the video in place.
  Result<void> finish();

 private:
  struct Frame {
    Image8 image;
    int times;
  };
  Recorder() = default;
  void encode();
  Result<void> encode(const Frame& frame, std::span<const float> audio);
  void close();

  std::filesystem::path target_;
  int width_ = 0, height_ = 0, fps_ = 30;
  OutputFiles files_{OutputFiles::WhenStopped::keep};  // declared before the video, which writes to them
  std::unique_ptr<session::VideoWriter> video_;
  std::int64_t frames_ = 0;
  int pending_repeats_ = 0;  // for frames dropped while the queue was full
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable queue_changed_;
  std::queue<Frame> queue_;
  std::vector<float> audio_;  // left and right interleaved, not written yet
  bool closed_ = false;
  std::optional<Error> error_;
};

}  // namespace intaglio::window
