#include "window/recorder.h"

#include <algorithm>
#include <utility>

namespace intaglio::window {

Result<std::unique_ptr<Recorder>> Recorder::start(const std::filesystem::path& target, int width, int height,
                                                  int fps, int sample_rate) {
  std::unique_ptr<Recorder> made(new Recorder);
  made->target_ = target;
  made->width_ = std::max(16, width - width % 2);  // H.264 needs whole 2 x 2 blocks
  made->height_ = std::max(16, height - height % 2);
  made->fps_ = fps;
  auto video = session::VideoWriter::create(
      made->files_, target,
      {.width = made->width_, .height = made->height_, .fps = fps, .sound_rate = sample_rate});
  if (!video) return tl::unexpected(video.error());
  made->video_ = std::move(*video);
  made->thread_ = std::thread([recorder = made.get()] { recorder->encode(); });
  return made;
}

Recorder::~Recorder() {
  close();
}

void Recorder::close() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  queue_changed_.notify_one();
  thread_.join();
}

Result<void> Recorder::add(const Image8& frame, double time) {
  const auto due = std::int64_t(time * fps_) + 1;
  const int times = int(std::max<std::int64_t>(0, due - frames_)) + pending_repeats_;
  if (times == 0) return {};
  const std::lock_guard lock(mutex_);
  if (error_) return tl::unexpected(*error_);
  frames_ = std::max(due, frames_);
  if (queue_.size() >= 8) {
    pending_repeats_ = times;
    return {};
  }
  pending_repeats_ = 0;
  queue_.push({frame, times});
  queue_changed_.notify_one();
  return {};
}

void Recorder::add_audio(std::span<const float> stereo) {
  const std::lock_guard lock(mutex_);
  if (!error_) audio_.insert(audio_.end(), stereo.begin(), stereo.end());
}

void Recorder::encode() {
  std::vector<float> audio;
  while (true) {
    Frame frame;
    audio.clear();
    {
      std::unique_lock lock(mutex_);
      queue_changed_.wait(lock, [&] { return !queue_.empty() || closed_; });
      if (queue_.empty() && audio_.empty()) return;
      if (!queue_.empty()) {
        frame = std::move(queue_.front());
        queue_.pop();
      }
      std::swap(audio, audio_);
    }
    if (const auto encoded = encode(frame, audio); !encoded) {
      const std::lock_guard lock(mutex_);
      error_ = encoded.error();
      return;
    }
  }
}

Result<void> Recorder::encode(const Frame& frame, std::span<const float> audio) {
  if (auto added = video_->add_sound(audio); !added) return added;
  for (int k = 0; k < frame.times; ++k) {
    if (auto added = video_->add(frame.image); !added) return added;
  }
  return {};
}

Result<void> Recorder::finish() {
  close();
  if (error_) return tl::unexpected(*error_);
  if (frames_ == 0) return fail(target_.string(), "nothing was recorded");
  if (const auto joined = video_->finish(); !joined) return tl::unexpected(joined.error());
  return files_.commit();
}

}  // namespace intaglio::window
