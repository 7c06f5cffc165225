#include "intaglio/window/gamepad.h"

#include <SDL2/SDL.h>

#include <algorithm>
#include <cmath>

#include "intaglio/session/scene_world.h"

namespace intaglio::window {

Gamepad::~Gamepad() {
  if (controller_ != nullptr && SDL_WasInit(SDL_INIT_GAMECONTROLLER) != 0)
    SDL_GameControllerClose(controller_);
}

void Gamepad::take(const SDL_Event& event) {
  if (event.type == SDL_CONTROLLERDEVICEADDED && controller_ == nullptr)
    controller_ = SDL_GameControllerOpen(event.cdevice.which);
  if (event.type == SDL_CONTROLLERDEVICEREMOVED && controller_ != nullptr &&
      event.cdevice.which == SDL_JoystickInstanceID(SDL_GameControllerGetJoystick(controller_))) {
    SDL_GameControllerClose(controller_);
    controller_ = nullptr;
  }
}

std::string Gamepad::name() const {
  const char* name = controller_ != nullptr ? SDL_GameControllerName(controller_) : nullptr;
  return name != nullptr ? name : "";
}

Vec2 Gamepad::stick(int x, int y) const {
  if (controller_ == nullptr) return Vec2::Zero();
  const auto axis = [&](int a) {
    return SDL_GameControllerGetAxis(controller_, static_cast<SDL_GameControllerAxis>(a)) / 32767.0;
  };
  const Vec2 at(axis(x), axis(y));
  return at.norm() < 0.15 ? Vec2::Zero().eval() : at;
}

Vec2 Gamepad::left() const {
  return stick(SDL_CONTROLLER_AXIS_LEFTX, SDL_CONTROLLER_AXIS_LEFTY);
}
Vec2 Gamepad::right() const {
  return stick(SDL_CONTROLLER_AXIS_RIGHTX, SDL_CONTROLLER_AXIS_RIGHTY);
}

unsigned Gamepad::shoulders() const {
  if (controller_ == nullptr) return 0;
  const auto pressed = [&](SDL_GameControllerButton b) {
    return SDL_GameControllerGetButton(controller_, b) != 0;
  };
  return (pressed(SDL_CONTROLLER_BUTTON_LEFTSHOULDER) ? session::left_key : 0) |
         (pressed(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER) ? session::right_key : 0);
}

Rumble rumble_of(const session::LiveState& state, std::uint64_t since) {
  Rumble rumble;
  const std::uint64_t oldest = state.marks > session::most_marks ? state.marks - session::most_marks : 0;
  for (std::uint64_t k = std::max(since, oldest); k < state.marks; ++k) {
    const session::ContactMark& mark = state.mark[k % session::most_marks];
    // 1 mN s is just felt, 1 N s shakes with all there is.
    const double size = mark.impulse.norm();
    const double strength = std::clamp(1 + std::log10(std::max(size, 1e-9)) / 3, 0.0, 1.0);
    double& felt = mark.begins ? rumble.blow : rumble.slide;
    felt = std::max(felt, mark.begins ? strength : 0.5 * strength);
  }
  return rumble;
}

void Gamepad::feel(const session::LiveState& state) {
  const Rumble rumble = rumble_of(state, felt_);
  felt_ = state.marks;
  if (controller_ == nullptr || (rumble.blow <= 0 && rumble.slide <= 0)) return;
  const auto motor = [](double x) { return static_cast<Uint16>(65535 * std::clamp(x, 0.0, 1.0)); };
  SDL_GameControllerRumble(controller_, motor(rumble.blow), motor(rumble.slide), 60);
}

}  // namespace intaglio::window
