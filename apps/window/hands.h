// What mouse, keys and gamepad do: camera, dragging, the pen, flippers, shortcuts. One thread (the window's).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intaglio/vec.h"
#include "session/live_session.h"
#include "window/settings.h"
#include "window/view_camera.h"

union SDL_Event;

namespace intaglio::window {

// Shortcuts that were pressed, for the application to do.
struct Wishes {
  bool quit = false, screenshot = false, record = false;
  std::vector<std::string> dropped;  // files
};

class Hands {
 public:
  explicit Hands(const render::Camera& camera) : camera_(camera) {}

  // An event that no panel wanted (`captured`: one did; then only releases count).
  void take(const SDL_Event& event, bool captured, Settings& settings, Wishes& wishes);
  // Once a picture: held keys fly, the dragged body and the pen follow.
  void follow(double seconds, const Settings& settings, session::LiveSession& session, double aspect);

  void look_from(const render::Camera& camera) { camera_ = ViewCamera(camera); }
  void reset() { ++controls_.resets; }
  void single() { ++controls_.single_steps; }
  void home() { camera_.home(); }
  void set_window(double width, double height) { window_ = {width, height}; }
  // The steering of a gamepad: sticks fly and turn, shoulders are the flippers.
  void steer(const Vec2& left, const Vec2& right, unsigned shoulders) {
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
  std::uint64_t taken() const { return taken_; }  // bodies that were dragged, since the start

 private:
  enum class Motion { none, orbit, look, pan, press };

  void press(int button, const Settings& settings);
  void move(const Vec2& to);
  void key(int scancode, bool down, bool repeated, Settings& settings, Wishes& wishes);
  void lead_pen(session::LiveSession& session, const Projection& projection);
  void drag(session::LiveSession& session, const Projection& projection);
  Vec2 place() const { return mouse_.cwiseQuotient(window_); }

  ViewCamera camera_;
  session::Controls controls_;
  Vec2 window_ = Vec2(1, 1), mouse_ = Vec2(0, 0);
  Motion motion_ = Motion::none;
  bool wants_body_ = false;  // a press that may have met one
  std::optional<Dragging> dragging_;
  std::uint64_t taken_ = 0;
  double press_ = 1;  // of the pen, in hundredths of the floor's side below it
  Vec3 flying_ = Vec3::Zero();
  unsigned keys_ = 0, shoulders_ = 0;
  Vec2 stick_left_ = Vec2::Zero(), stick_right_ = Vec2::Zero();
};

}  // namespace intaglio::window

// The first gamepad that is plugged in: its sticks and shoulders, and rumble from contacts. SDL2; one thread.

struct _SDL_GameController;
union SDL_Event;

namespace intaglio::window {

class Gamepad {
 public:
  ~Gamepad();
  void take(const SDL_Event& event);  // plugged in, pulled out
  std::string name() const;           // empty: none
  Vec2 left() const;
  Vec2 right() const;
  unsigned shoulders() const;  // left_key, right_key of world.h
  // Rumbles as hard as what has touched since the last call: a blow shakes the heavy motor, sliding the light
  // one.
  void feel(const session::LiveState& state);

 private:
  Vec2 stick(int x, int y) const;

  _SDL_GameController* controller_ = nullptr;
  std::uint64_t felt_ = 0;
};

// How hard contacts shake, 0..1: blows by the logarithm of their impulse, the rest by force. Pure.
struct Rumble {
  double blow = 0, slide = 0;
};
Rumble rumble_of(const session::LiveState& state, std::uint64_t since);

}  // namespace intaglio::window
