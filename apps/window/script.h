// A script that plays the user: events at times, pushed into SDL's own queue, so that what a test drives is
// what a hand drives.
//
// One event a line: TIME VERB ARGUMENTS. Seconds since the first picture, ascending. # begins a comment.
//
//   key NAME         pressed and let go; SDL's names: Space, R, F9, Left
//   hold NAME, release NAME
//   move X Y         the mouse; parts of the window, 0..1, from its upper left corner
//   point BODY       the mouse to where the middle of a body is seen; 1 is the scene's first
//                    ball, 0 the first that is seen and can be dragged
//   down BUTTON, up BUTTON       left, middle or right
//   wheel NOTCHES    forward is positive
//   drop FILE        a file dropped onto the window
//   resize W H       of the window, pixels
//   set NAME VALUE   a control of the panels by name (docs/run.md)
//   device NAME      the pen: a VRPN device, NAME@HOST[:PORT], or mouse
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

enum class Verb {
  key,
  hold,
  release,
  move,
  point,
  down,
  up,
  wheel,
  drop,
  resize,
  set,
  device,
  screenshot,
  quit
};

struct ScriptEvent {
  double time = 0;  // s
  Verb verb = Verb::quit;
  std::string text;     // a key, a button, a file, a device, or what is set
  double x = 0, y = 0;  // of move, point, wheel, resize, set
  int line = 0;
  std::string where;  // "file:line", for errors
};

// `name` stands for the file in errors, which carry the line. What cannot be meant is an error here: keys and
// settings that there are not, numbers out of range, devices that are no address. Whether a body or a device
// is there shows only when its line is due.
Result<std::vector<ScriptEvent>> parse_script(std::string_view text, const std::string& name);

// Plays a script into SDL's event queue as time goes on. One thread (the window's).

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
