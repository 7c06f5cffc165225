// Records what the window shows, with what is heard, into an MP4: frames at a fixed rate whatever the
// window's is, sound in stereo as it is played. Encoding is done by a thread of its own and by ffmpeg; the
// window never waits for it: frames that find the queue full repeat the one before.
//
// One thread (the window's). When the disk is full or ffmpeg dies, add() says so once and recording is over.
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
  bool wants(double time) const { return static_cast<std::int64_t>(time * fps_) >= frames_; }
  Result<void> add(const Image8& frame, double time);
  void hear(std::span<const float> stereo);
  double seconds() const { return static_cast<double>(frames_) / fps_; }
  std::uint64_t repeated() const { return repeated_; }

  // Joins picture and sound and puts the video in place.
  Result<void> finish();

 private:
  struct Frame {
    Image8 image;
    int times;
  };
  Recorder() = default;
  void work();
  void close();

  std::filesystem::path target_;
  int width_ = 0, height_ = 0, fps_ = 30, sample_rate_ = 44'100;
  std::unique_ptr<session::VideoWriter> video_;
  std::vector<float> audio_;  // left and right by turns
  std::int64_t frames_ = 0;
  std::uint64_t repeated_ = 0;
  int owed_ = 0;  // frames that found no room
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable work_;
  std::queue<Frame> queue_;
  bool closed_ = false;
  std::optional<Error> error_;
};

}  // namespace intaglio::window
