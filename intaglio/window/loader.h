// Makes live sessions in a thread of its own, so that the window goes on while textures are read. Asked again
// while it works, it makes what was asked for last. One thread (the window's).
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "intaglio/session/live/live_session.h"

namespace intaglio::window {

struct LoadRequest {
  session::Scene scene;
  session::LiveOptions options;
  std::shared_ptr<haptics::Device> device;       // the pen's; none: the mouse
  std::optional<session::SceneSurface> surface;  // when it is known already
  bool goes_on = false;                          // bodies go on where they are
};

struct Loaded {
  std::unique_ptr<session::LiveSession> session;  // null: see error
  std::optional<Error> error;
  LoadRequest request;
};

class Loader {
 public:
  Loader();
  ~Loader();

  void ask(LoadRequest request);
  std::optional<Loaded> take();
  bool is_busy();

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<LoadRequest> wanted_;
  std::optional<Loaded> done_;
  bool busy_ = false, closed_ = false;
  std::thread thread_;
};

}  // namespace intaglio::window
