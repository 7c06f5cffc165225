// Plays a script into SDL's event queue as time goes on. One thread (the window's).
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "intaglio/core/vec.h"
#include "intaglio/window/script.h"
#include "intaglio/window/sdl_window.h"
#include "intaglio/window/settings.h"

namespace intaglio::window {

class ScriptPlayer {
 public:
  explicit ScriptPlayer(std::vector<ScriptEvent> events) : events_(std::move(events)) {}

  // The place of a body in the window, 0..1; an error when there is none or it is not seen.
  using Where = std::function<Result<Vec2>(std::size_t body)>;
  // Pushes what is due, one event a call for those that pictures must see one by one. The clock starts with
  // the first call.
  void play(SdlWindow& window, Settings& settings, std::vector<std::string>& messages, const Where& where);
  // A file to which a screenshot of this picture should go.
  const std::string& screenshot() const { return screenshot_; }
  void stop() { over_ = true; }
  bool is_over() const { return over_; }

 private:
  void push(const ScriptEvent& event, SdlWindow& window, Settings& settings,
            std::vector<std::string>& messages, const Where& where);
  void move_mouse(const Vec2& place, const SdlWindow& window);

  std::vector<ScriptEvent> events_;
  std::size_t next_ = 0;
  std::chrono::steady_clock::time_point start_;
  bool started_ = false, over_ = false;
  int x_ = 0, y_ = 0;
  unsigned buttons_ = 0;
  std::string screenshot_;
};

}  // namespace intaglio::window
