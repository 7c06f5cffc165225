// A script of user input: events at times, pushed into SDL's own queue, so that tests use the same path as a
// user.
//
// One event a line: TIME VERB ARGUMENTS. Seconds since the first picture, ascending. # begins a comment.
//
//   key NAME                     pressed and released; SDL's names: Space, R, F9, Left
//   hold NAME, release NAME
//   move X Y                     the mouse, in fractions of the window from its upper left corner
//   point BODY                   moves the mouse to a body's projected centre; 1 is the scene's first ball,
//                                0 the first visible draggable body
//   down BUTTON, up BUTTON       left, middle or right
//   wheel NOTCHES                forward is positive
//   drop FILE                    a file dropped onto the window
//   resize W H                   the window, pixels
//   set NAME VALUE               a control of the panels by name (docs/run.md)
//   device NAME                  the pen: a VRPN device, NAME@HOST[:PORT], or mouse
//   screenshot FILE
//   quit
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/vec.h"
#include "window/sdl_window.h"
#include "window/settings.h"

namespace intaglio::window {

// clang-format off
enum class ScriptVerb {
  key, hold, release, move, point, down, up, wheel, drop, resize, set, device, screenshot, quit
};
// clang-format on

struct ScriptEvent {
  double time = 0;  // s
  ScriptVerb verb = ScriptVerb::quit;
  std::string text;     // key, button, file, device or setting
  double x = 0, y = 0;  // of move, point, wheel, resize, set
  std::string where;    // "file:line", for errors
};

// `name` is the file's in errors, which say the line. Unknown keys or settings, numbers out of range and
// malformed device addresses are rejected here; whether a body or a device is there shows only when its line
// is due.
Result<std::vector<ScriptEvent>> parse_script(std::string_view text, const std::string& name);

// Plays a script into SDL's event queue. One thread (the window's).
class ScriptPlayer {
 public:
  explicit ScriptPlayer(std::vector<ScriptEvent> events) : events_(std::move(events)) {}

  // A body's position in fractions of the window; an error when it does not exist or is not visible.
  using LocateBody = std::function<Result<Vec2>(std::size_t body)>;
  // Pushes the events that are due, but at most one that must have a frame of its own. The clock starts with
  // the first call.
  void play(SdlWindow& window, Settings& settings, std::vector<std::string>& messages,
            const LocateBody& locate);
  // The file for a screenshot of this picture; empty: none.
  const std::string& screenshot() const { return screenshot_; }
  void stop() { finished_ = true; }
  bool is_finished() const { return finished_; }

 private:
  void push(const ScriptEvent& event, SdlWindow& window, Settings& settings,
            std::vector<std::string>& messages, const LocateBody& locate);
  void move_mouse(const Vec2& place, const SdlWindow& window);
  void press_button(int button, bool down);

  std::vector<ScriptEvent> events_;
  std::size_t next_ = 0;
  std::chrono::steady_clock::time_point start_;
  bool started_ = false, finished_ = false;
  int x_ = 0, y_ = 0;
  unsigned buttons_ = 0;
  std::string screenshot_;
};

}  // namespace intaglio::window
