#include "window/hands.h"

#include <SDL2/SDL.h>

#include <algorithm>
#include <cmath>

#include "scene/world.h"
#include "window/view_camera.h"

namespace intaglio::window {

void Hands::take(const SDL_Event& event, bool captured, Settings& settings, Wishes& wishes) {
  switch (event.type) {
    case SDL_QUIT:
      wishes.quit = true;
      return;
    case SDL_DROPFILE:
      wishes.dropped.emplace_back(event.drop.file);
      SDL_free(event.drop.file);
      return;
    case SDL_MOUSEMOTION:
      move({static_cast<double>(event.motion.x), static_cast<double>(event.motion.y)});
      return;
    case SDL_MOUSEBUTTONDOWN:
      mouse_ = {static_cast<double>(event.button.x), static_cast<double>(event.button.y)};
      if (!captured) press(event.button.button, settings);
      return;
    case SDL_MOUSEBUTTONUP:
      motion_ = Motion::none;
      wants_body_ = false;
      dragging_.reset();
      return;
    case SDL_MOUSEWHEEL:
      if (captured) return;
      if (motion_ == Motion::press) {
        press_ = std::clamp(press_ * std::pow(1.15, event.wheel.y), 0.05, 10.0);
      } else {
        camera_.zoom(event.wheel.y);
      }
      return;
    case SDL_KEYDOWN:
    case SDL_KEYUP:
      if (!captured || event.type == SDL_KEYUP)
        key(event.key.keysym.scancode, event.type == SDL_KEYDOWN, event.key.repeat != 0, settings, wishes);
      return;
    default:
      return;
  }
}

void Hands::press(int button, const Settings& settings) {
  if (button == SDL_BUTTON_RIGHT) {
    motion_ = Motion::look;
  } else if (button == SDL_BUTTON_MIDDLE) {
    motion_ = Motion::pan;
  } else if (settings.pen) {
    motion_ = Motion::press;
  } else {
    motion_ = Motion::orbit;
    wants_body_ = true;
  }
}

void Hands::move(const Vec2& to) {
  const Vec2 step = (to - mouse_) / window_.y();
  mouse_ = to;
  if (dragging_ || wants_body_) return;
  if (motion_ == Motion::orbit) camera_.orbit(step.x(), step.y());
  if (motion_ == Motion::look) camera_.look(step.x(), step.y());
  if (motion_ == Motion::pan) camera_.pan(step.x(), step.y());
}

void Hands::key(int scancode, bool down, bool repeated, Settings& settings, Wishes& wishes) {
  const double flies = down ? 1 : 0;
  const auto flipper = [&](unsigned bit) { keys_ = down ? keys_ | bit : keys_ & ~bit; };
  switch (scancode) {
    case SDL_SCANCODE_D:
      flying_.x() = flies;
      return;
    case SDL_SCANCODE_A:
      flying_.x() = -flies;
      return;
    case SDL_SCANCODE_E:
      flying_.y() = flies;
      return;
    case SDL_SCANCODE_Q:
      flying_.y() = -flies;
      return;
    case SDL_SCANCODE_W:
      flying_.z() = flies;
      return;
    case SDL_SCANCODE_S:
      flying_.z() = -flies;
      return;
    case SDL_SCANCODE_LEFT:
    case SDL_SCANCODE_Z:
      flipper(scene::left_key);
      return;
    case SDL_SCANCODE_RIGHT:
    case SDL_SCANCODE_SLASH:
      flipper(scene::right_key);
      return;
    default:
      break;
  }
  if (!down) return;
  if (scancode == SDL_SCANCODE_N) single();  // goes on while it is held
  if (repeated) return;
  switch (scancode) {
    case SDL_SCANCODE_SPACE:
      settings.paused = !settings.paused;
      return;
    case SDL_SCANCODE_R:
      reset();
      return;
    case SDL_SCANCODE_B:
      settings.speed = settings.speed < 1 ? 1 : 0.1;
      return;
    case SDL_SCANCODE_P:
      settings.pen = !settings.pen;
      return;
    case SDL_SCANCODE_M:
      settings.mute = !settings.mute;
      return;
    case SDL_SCANCODE_H:
      home();
      return;
    case SDL_SCANCODE_TAB:
      settings.panels = !settings.panels;
      return;
    case SDL_SCANCODE_1:
      settings.representation = 0;
      return;
    case SDL_SCANCODE_2:
      settings.representation = 1;
      return;
    case SDL_SCANCODE_3:
      settings.representation = 2;
      return;
    case SDL_SCANCODE_F9:
      wishes.record = true;
      return;
    case SDL_SCANCODE_F12:
      wishes.screenshot = true;
      return;
    case SDL_SCANCODE_ESCAPE:
      wishes.quit = true;
      return;
    default:
      return;
  }
}

void Hands::follow(double seconds, const Settings& settings, session::LiveSession& session, double aspect) {
  const Vec3 sticks(stick_left_.x(), 0, -stick_left_.y());
  if (const Vec3 fly = flying_ + sticks; fly.norm() > 0.01) camera_.fly(0.8 * seconds * fly);
  if (stick_right_.norm() > 0.01)
    camera_.orbit(-0.5 * seconds * stick_right_.x(), 0.5 * seconds * stick_right_.y());
  const Projection projection(camera_.camera(), aspect);
  drag(session, projection);
  if (settings.pen) lead_pen(session, projection);
  controls_.paused = settings.paused;
  controls_.speed = std::clamp(settings.speed, 0.01, 1.0);
  controls_.keys = keys_ | shoulders_;
  session.set_controls(controls_);
}

// The body under the mouse is pulled in the plane that faces the camera and went through it when it was
// taken.
void Hands::drag(session::LiveSession& session, const Projection& projection) {
  const session::LiveState& state = session.state();
  const Vec3 ray = projection.ray(place());
  if (std::exchange(wants_body_, false)) {
    const auto picked = pick_body(session.scene(), {state.pose.data(), state.bodies}, projection.eye, ray);
    const auto floor = pick_floor(*session.surface().surface, false, projection.eye, ray);
    const bool hidden = picked && floor && (*floor - projection.eye).norm() < picked->distance - 0.05;
    if (picked && !hidden && session.is_free(picked->body)) {
      dragging_ = {picked->body, state.pose[picked->body - 1].to_local(picked->point),
                   picked->distance * ray.dot(projection.ahead)};
      ++taken_;
    }
  }
  controls_.dragged = dragging_ ? dragging_->body : floor_body;
  if (!dragging_) return;
  controls_.grip = dragging_->grip;
  controls_.pull_to = projection.eye + ray * (dragging_->distance / ray.dot(projection.ahead));
}

// Over the floor the pen hovers; with the button held it is pressed into it.
void Hands::lead_pen(session::LiveSession& session, const Projection& projection) {
  const surface::Surface* touched = session.surface().surface.get();
  const bool has_relief = motion_ != Motion::press;
  auto at = pick_floor(*touched, has_relief, projection.eye, projection.ray(place()));
  // The nearest surface whose rectangle is met.
  const auto covers = [](const surface::Surface& s, const Vec3& p) {
    return s.placement().covers(s.placement().to_local(p));
  };
  if (at && !covers(*touched, *at) && !session.surface().grounds.empty()) at.reset();
  std::optional<PickedBase> curved;
  for (const scene::SceneSurface& ground : session.surface().grounds) {
    if (ground.curved) {
      const auto there = pick_base(ground.curved->base().mesh(), projection.eye, projection.ray(place()));
      if (!there || (at && (*at - projection.eye).norm() < (there->point - projection.eye).norm())) continue;
      at = there->point;
      curved = there;
      touched = ground.surface.get();
      continue;
    }
    const auto there = pick_floor(*ground.surface, has_relief, projection.eye, projection.ray(place()));
    if (!there || !covers(*ground.surface, *there)) continue;
    if (at && (*at - projection.eye).norm() < (*there - projection.eye).norm()) continue;
    at = there;
    curved.reset();
    touched = ground.surface.get();
  }
  if (!at) return;
  const surface::Surface& floor = *touched;
  const surface::Placement& placement = floor.placement();
  const double side = std::max(placement.size_u(), placement.size_v());
  const Vec3 normal = curved ? curved->normal : placement.n();
  if (motion_ != Motion::press) return session.set_pen_target(*at + 0.02 * side * normal);
  if (curved) return session.set_pen_target(*at - (floor.max_depth() + 0.01 * press_ * side) * normal);
  const Vec3 local = placement.to_local(*at);
  const double depth = placement.covers(local) ? floor.depth(placement.uv(local)) : 0;
  session.set_pen_target(*at - (depth + 0.01 * press_ * side) * placement.n());
}

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
  return (pressed(SDL_CONTROLLER_BUTTON_LEFTSHOULDER) ? scene::left_key : 0) |
         (pressed(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER) ? scene::right_key : 0);
}

Rumble rumble_of(const session::LiveState& state, std::uint64_t since) {
  Rumble rumble;
  const std::uint64_t oldest =
      state.mark_count > session::max_marks ? state.mark_count - session::max_marks : 0;
  for (std::uint64_t k = std::max(since, oldest); k < state.mark_count; ++k) {
    const session::ContactMark& mark = state.marks[k % session::max_marks];
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
  felt_ = state.mark_count;
  if (controller_ == nullptr || (rumble.blow <= 0 && rumble.slide <= 0)) return;
  const auto motor = [](double x) { return static_cast<Uint16>(65535 * std::clamp(x, 0.0, 1.0)); };
  SDL_GameControllerRumble(controller_, motor(rumble.blow), motor(rumble.slide), 60);
}

}  // namespace intaglio::window
