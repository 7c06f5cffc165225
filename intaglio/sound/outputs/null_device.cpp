#include "intaglio/sound/outputs/null_device.h"

namespace intaglio::sound {

NullDevice::NullDevice(int sample_rate, int buffer_frames)
    : sample_rate_(sample_rate), buffer_frames_(buffer_frames), buffer_(2 * std::size_t(buffer_frames)) {}

Result<void> NullDevice::start(AudioSource& source) {
  if (thread_.joinable()) return fail("null audio device", "is playing already");
  is_stopping_ = false;
  thread_ = std::thread([this, &source] { play(source); });
  return {};
}

void NullDevice::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void NullDevice::play(AudioSource& source) {
  using Clock = std::chrono::steady_clock;
  const auto period = std::chrono::nanoseconds(std::int64_t{1'000'000'000} * buffer_frames_ / sample_rate_);
  auto due = Clock::now();
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    lock.unlock();
    const auto late = Clock::now() - due;
    if (late > period) {
      meter_.count_underruns(static_cast<std::uint64_t>(late / period));
      due += late / period * period;
    }
    meter_.render(source, buffer_, sample_rate_);
    due += period;
    lock.lock();
    wake_.wait_until(lock, due, [this] { return is_stopping_; });
  }
}

}  // namespace intaglio::sound
