// The gamepad, played by SDL's virtual one: sticks, shoulders and motors.
#include <SDL2/SDL.h>
#include <doctest/doctest.h>

#include <vector>

#include "scene/world.h"
#include "tests/skipped.h"
#include "window/input.h"

using namespace intaglio;
using namespace intaglio::window;

namespace {

struct Shake {
  Uint16 heavy, light;
};

// A pad that is plugged in for as long as this lives, and records its rumble.
class VirtualPad {
 public:
  VirtualPad() {
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    is_there_ = SDL_Init(SDL_INIT_GAMECONTROLLER) == 0;
    SDL_VirtualJoystickDesc pad{};
    pad.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    pad.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    pad.naxes = SDL_CONTROLLER_AXIS_MAX;
    pad.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
    pad.name = "Virtual pad";
    pad.userdata = &shakes_;
    pad.Rumble = [](void* shakes, Uint16 heavy, Uint16 light) {
      static_cast<std::vector<Shake>*>(shakes)->push_back({heavy, light});
      return 0;
    };
    index_ = is_there_ ? SDL_JoystickAttachVirtualEx(&pad) : -1;
    is_there_ = index_ >= 0;
  }
  ~VirtualPad() { SDL_Quit(); }

  explicit operator bool() const { return is_there_; }
  SDL_Joystick* stick() const { return SDL_JoystickFromInstanceID(SDL_JoystickGetDeviceInstanceID(index_)); }
  void axis(int axis, int value) {
    SDL_JoystickSetVirtualAxis(stick(), axis, static_cast<Sint16>(value));
    SDL_JoystickUpdate();
  }
  void button(int button, bool down) {
    SDL_JoystickSetVirtualButton(stick(), button, down ? 1 : 0);
    SDL_JoystickUpdate();
  }
  void unplug() { SDL_JoystickDetachVirtual(index_); }
  const std::vector<Shake>& shakes() const { return shakes_; }

 private:
  bool is_there_ = false;
  int index_ = -1;
  std::vector<Shake> shakes_;
};

void take_events(Gamepad& gamepad) {
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) gamepad.handle_event(event);
}

void touch(session::LiveState& state, bool begins, double impulse) {
  session::ContactMark& mark = state.marks[state.mark_count++ % session::max_marks];
  mark.begins = begins;
  mark.impulse = {0, impulse, 0};
}

}  // namespace

TEST_CASE("a gamepad is opened when plugged in, read while connected, and closed when unplugged") {
  VirtualPad pad;
  if (!pad) {
    tests::skipped(std::string("SDL has no virtual gamepad here: ") + SDL_GetError());
    return;
  }
  Gamepad gamepad;
  CHECK(gamepad.name().empty());
  CHECK(gamepad.left() == Vec2::Zero());
  take_events(gamepad);
  CHECK(gamepad.name() == "Virtual pad");

  pad.axis(SDL_CONTROLLER_AXIS_LEFTX, 32767);
  pad.axis(SDL_CONTROLLER_AXIS_LEFTY, -16384);
  pad.axis(SDL_CONTROLLER_AXIS_RIGHTX, 3000);  // a stick at rest is never exactly centred
  CHECK((gamepad.left() - Vec2(1, -0.5)).norm() < 1e-3);
  CHECK(gamepad.right() == Vec2::Zero());
  pad.axis(SDL_CONTROLLER_AXIS_RIGHTY, 32767);
  CHECK(gamepad.right().y() == 1);
  CHECK(gamepad.shoulders() == 0);
  pad.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  CHECK(gamepad.shoulders() == scene::right_key);
  pad.button(SDL_CONTROLLER_BUTTON_LEFTSHOULDER, true);
  CHECK(gamepad.shoulders() == (scene::left_key | scene::right_key));

  pad.unplug();
  take_events(gamepad);
  CHECK(gamepad.name().empty());
  CHECK(gamepad.shoulders() == 0);
}

TEST_CASE("impacts drive the heavy motor, sliding the light one, each once") {
  VirtualPad pad;
  if (!pad) {
    tests::skipped(std::string("SDL has no virtual gamepad here: ") + SDL_GetError());
    return;
  }
  Gamepad gamepad;
  take_events(gamepad);
  session::LiveState state;
  gamepad.rumble(state);
  CHECK(pad.shakes().empty());
  touch(state, true, 0.1);
  gamepad.rumble(state);
  REQUIRE(pad.shakes().size() == 1);
  CHECK(pad.shakes()[0].heavy == doctest::Approx(65535 * contact_rumble(state, 0).impact).epsilon(1e-3));
  CHECK(pad.shakes()[0].light == 0);
  gamepad.rumble(state);  // no new contact
  CHECK(pad.shakes().size() == 1);
  touch(state, false, 0.1);
  gamepad.rumble(state);
  REQUIRE(pad.shakes().size() == 2);
  CHECK(pad.shakes()[1].heavy == 0);
  CHECK(pad.shakes()[1].light > 0);
  touch(state, true, 1e3);
  gamepad.rumble(state);
  CHECK(pad.shakes().back().heavy == 65535);
}
