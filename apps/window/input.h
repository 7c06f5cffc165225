// Mouse, keyboard and gamepad: camera, dragging, the pen, flippers, shortcuts. One thread (the window's).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intaglio/vec.h"
#include "session/live_session.h"
#include "window/settings.h"
#include "window/view_camera.h"

struct _SDL_GameController;
union SDL_Event;

namespace intaglio::window {

// Commands requested by shortcuts, for the application.
struct InputCommands {
  bool quit = false, screenshot = false, record = false;
  std::vector<std::string> dropped_files;
};

class InputController {
 public:
  explicit InputController(const render::Camera& camera) : camera_(camera) {}

  // Handles an event; if `captured` by a panel, only releases count.
  void handle_event(const SDL_Event& event, bool captured, Settings& settings, InputCommands& commands);
  // Per frame: applies held keys, drags the body, moves the pen.
  void update(double seconds, const Settings& settings, session::LiveSession& session, double aspect);

  void set_camera(const render::Camera& camera) { camera_ = ViewCamera(camera); }
  void reset() { ++controls_.resets; }
  void single() { ++controls_.single_steps; }
  void home() { camera_.home(); }
  void set_window(double width, double height) { window_ = {width, height}; }
  // Gamepad input: sticks fly and turn, shoulders are the flippers.
  void set_gamepad(const Vec2& left, const Vec2& right, unsigned shoulders) {
    stick_left_ = left;
    stick_right_ = right;
    shoulders_ = shoulders;
  }

  const ViewCamera& camera() const { return camera_; }
  const session::Controls& controls() const { return controls_; }
  struct Dragging {
    BodyId body;
    Vec3 grip;        // in the body's frame
    double distance;  // along the ray
  };
  const std::optional<Dragging>& dragging() const { return dragging_; }
  std::uint64_t dragged_count() const { return dragged_count_; }  // bodies dragged so far

 private:
  enum class DragMode { none, orbit, look, pan, press_pen };

  void press(int button, const Settings& settings);
  void move(const Vec2& to);
  bool held_key(int scancode, bool down);  // whether it is one that acts while it is held
  void key(int scancode, bool down, bool repeated, Settings& settings, InputCommands& commands);
  void move_pen(session::LiveSession& session, const Projection& projection);
  void drag(session::LiveSession& session, const Projection& projection);
  Vec2 mouse_position() const { return mouse_.cwiseQuotient(window_); }

  ViewCamera camera_;
  session::Controls controls_;
  Vec2 window_ = Vec2(1, 1), mouse_ = Vec2(0, 0);
  DragMode drag_mode_ = DragMode::none;
  bool pick_pending_ = false;  // a press may hit a body
  std::optional<Dragging> dragging_;
  std::uint64_t dragged_count_ = 0;
  double press_depth_ = 1;  // of the pen, 1/100 of the floor's side
  Vec3 flying_ = Vec3::Zero();
  unsigned keys_ = 0, shoulders_ = 0;
  Vec2 stick_left_ = Vec2::Zero(), stick_right_ = Vec2::Zero();
};

// The first gamepad that is plugged in: its sticks and shoulders, and rumble from contacts. SDL2; one thread.
class Gamepad {
 public:
  ~Gamepad();
  void handle_event(const SDL_Event& event);  // plugged in, unplugged
  std::string name() const;                   // empty: none
  Vec2 left() const;
  Vec2 right() const;
  unsigned shoulders() const;  // left_key, right_key of world.h
  // Rumbles by the contacts since the last call: impacts drive the low-frequency motor, sliding the
  // high-frequency one.
  void rumble(const session::LiveState& state);

 private:
  Vec2 stick(int x, int y) const;

  _SDL_GameController* controller_ = nullptr;
  std::uint64_t rumbled_marks_ = 0;
};

// Motor strengths, 0..1, for the contacts after the first `since`. A contact of J N s has the strength
// 1 + log10(J) / 3: 0 at 1 mN s, the threshold, and 1 at 1 N s. Pure.
struct Rumble {
  double impact = 0, slide = 0;
};
Rumble contact_rumble(const session::LiveState& state, std::uint64_t since);

}  // namespace intaglio::window
