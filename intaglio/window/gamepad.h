// The first gamepad that is plugged in: its sticks and shoulders, and rumble from contacts. SDL2; one thread.
#pragma once

#include <string>

#include "intaglio/core/vec.h"
#include "intaglio/session/live/live_state.h"

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
  unsigned shoulders() const;  // left_key, right_key of scene_world.h
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
