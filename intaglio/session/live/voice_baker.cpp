#include "intaglio/session/live/voice_baker.h"

#include <sys/resource.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <thread>

namespace intaglio::session {

struct VoiceBaker::Shared {
  struct Order {
    std::uint64_t ticket = 0;
    Scene scene;
    SceneSurface surface;
    std::filesystem::path cache;
  };

  std::mutex mutex;
  std::condition_variable wake;
  std::optional<Order> wanted;
  std::uint64_t tickets = 0, done_ticket = 0;
  std::optional<Result<Voices>> done;
  std::atomic<bool> newer{false};  // than what is being made
  bool busy = false, closed = false;
};

VoiceBaker::VoiceBaker() : shared_(std::make_shared<Shared>()) {
  std::thread([shared = shared_] { work(shared); }).detach();
}

VoiceBaker::~VoiceBaker() {
  const std::lock_guard lock(shared_->mutex);
  shared_->closed = true;
  shared_->newer = true;
  shared_->wake.notify_one();
}

std::uint64_t VoiceBaker::ask(const Scene& scene, const SceneSurface& surface,
                              const std::filesystem::path& cache) {
  const std::lock_guard lock(shared_->mutex);
  shared_->wanted = {++shared_->tickets, scene, surface, cache};
  shared_->newer = true;
  shared_->wake.notify_one();
  return shared_->tickets;
}

std::optional<Result<Voices>> VoiceBaker::take(std::uint64_t ticket) {
  const std::lock_guard lock(shared_->mutex);
  if (!shared_->done || shared_->done_ticket != ticket) return std::nullopt;
  return std::exchange(shared_->done, std::nullopt);
}

bool VoiceBaker::is_busy() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->busy;
}

void VoiceBaker::work(const std::shared_ptr<Shared>& shared) {
  // Physics and pictures go first. On Linux a thread has a niceness of its own; failing changes nothing.
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);
  std::unique_lock lock(shared->mutex);
  while (true) {
    shared->wake.wait(lock, [&] { return shared->wanted || shared->closed; });
    if (shared->closed) return;
    const Shared::Order order = std::move(*std::exchange(shared->wanted, std::nullopt));
    shared->newer = false;
    shared->busy = true;
    lock.unlock();
    auto voices = bake_voices(order.scene, order.surface, {order.cache, &shared->newer});
    lock.lock();
    shared->busy = false;
    if (shared->wanted) continue;
    shared->done = std::move(voices);
    shared->done_ticket = order.ticket;
  }
}

}  // namespace intaglio::session
