#include "intaglio/window/loader.h"

namespace intaglio::window {

namespace {

Loaded load(LoadRequest request) {
  Loaded loaded;
  if (!request.surface) {
    auto surface = session::make_surface(request.scene);
    if (surface) {
      request.surface = std::move(*surface);
    } else {
      loaded.error = surface.error();
    }
  }
  if (request.surface) {
    auto session =
        session::LiveSession::create(request.scene, *request.surface, request.options, request.device.get());
    if (session) {
      loaded.session = std::move(*session);
    } else {
      loaded.error = session.error();
    }
  }
  loaded.request = std::move(request);
  return loaded;
}

}  // namespace

Loader::Loader() : thread_([this] { work(); }) {}

Loader::~Loader() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Loader::ask(LoadRequest request) {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = std::move(request);
  }
  wake_.notify_one();
}

std::optional<Loaded> Loader::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, std::nullopt);
}

bool Loader::is_busy() {
  const std::lock_guard lock(mutex_);
  return busy_ || wanted_ || done_;
}

void Loader::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return wanted_ || closed_; });
    if (closed_) return;
    LoadRequest request = std::move(*std::exchange(wanted_, std::nullopt));
    busy_ = true;
    lock.unlock();
    Loaded loaded = load(std::move(request));
    lock.lock();
    done_ = std::move(loaded);
    busy_ = false;
  }
}

}  // namespace intaglio::window
