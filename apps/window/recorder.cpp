#include "window/recorder.h"

#include <algorithm>

namespace intaglio::window {

Result<std::unique_ptr<Recorder>> Recorder::start(const std::filesystem::path& target, int width, int height,
                                                  int fps, int sample_rate) {
  std::unique_ptr<Recorder> made(new Recorder);
  made->target_ = target;
  made->width_ = std::max(16, width - width % 2);  // H.264 needs whole 2 x 2 blocks
  made->height_ = std::max(16, height - height % 2);
  made->fps_ = fps;
  made->sample_rate_ = sample_rate;
  // Every recording has a new name, so that no later one would remove what a killed session left.
  remove_stale_temporaries(target.parent_path());
  auto video = session::VideoWriter::create(made->files_, target, made->width_, made->height_, fps);
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
  audio_.insert(audio_.end(), stereo.begin(), stereo.end());
}

void Recorder::encode() {
  while (true) {
    Frame frame;
    {
      std::unique_lock lock(mutex_);
      queue_changed_.wait(lock, [&] { return !queue_.empty() || closed_; });
      if (queue_.empty()) return;
      frame = std::move(queue_.front());
      queue_.pop();
    }
    for (int k = 0; k < frame.times; ++k) {
      const auto added = video_->add(frame.image);
      if (added) continue;
      const std::lock_guard lock(mutex_);
      error_ = added.error();
      return;
    }
  }
}

Result<void> Recorder::finish() {
  close();
  if (error_) return tl::unexpected(*error_);
  if (frames_ == 0) return fail(target_.string(), "nothing was recorded");
  // Trim or pad the audio to the video's length.
  audio_.resize(2 * std::size_t(seconds() * sample_rate_));
  if (const auto joined = video_->finish(audio_, sample_rate_); !joined)
    return tl::unexpected(joined.error());
  return files_.commit();
}

}  // namespace intaglio::window
