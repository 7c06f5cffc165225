#include "window/input.h"

#include <SDL2/SDL.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "scene/world.h"
#include "window/view_camera.h"

namespace intaglio::window {

void InputController::handle_event(const SDL_Event& event, bool captured, Settings& settings,
                                   InputCommands& commands) {
  switch (event.type) {
    case SDL_QUIT:
      commands.quit = true;
      return;
    case SDL_DROPFILE:
      commands.dropped_files.emplace_back(event.drop.file);
      SDL_free(event.drop.file);
      return;
    case SDL_MOUSEMOTION:
      move({double(event.motion.x), double(event.motion.y)});
      return;
    case SDL_MOUSEBUTTONDOWN:
      mouse_ = {double(event.button.x), double(event.button.y)};
      if (!captured) press(event.button.button, settings);
      return;
    case SDL_MOUSEBUTTONUP:
      drag_mode_ = DragMode::none;
      pick_pending_ = false;
      dragging_.reset();
      return;
    case SDL_MOUSEWHEEL:
      if (captured) return;
      if (drag_mode_ == DragMode::press_pen) {
        press_depth_ = std::clamp(press_depth_ * std::pow(1.15, event.wheel.y), 0.05, 10.0);
      } else {
        camera_.zoom(event.wheel.y);
      }
      return;
    case SDL_KEYDOWN:
    case SDL_KEYUP:
      if (!captured || event.type == SDL_KEYUP)
        key(event.key.keysym.scancode, event.type == SDL_KEYDOWN, event.key.repeat != 0, settings, commands);
      return;
    default:
      return;
  }
}

void InputController::press(int button, const Settings& settings) {
  if (button == SDL_BUTTON_RIGHT) {
    drag_mode_ = DragMode::look;
  } else if (button == SDL_BUTTON_MIDDLE) {
    drag_mode_ = DragMode::pan;
  } else if (settings.pen) {
    drag_mode_ = DragMode::press_pen;
  } else {
    drag_mode_ = DragMode::orbit;
    pick_pending_ = true;
  }
}

void InputController::move(const Vec2& to) {
  const Vec2 step = (to - mouse_) / window_.y();
  mouse_ = to;
  if (dragging_ || pick_pending_) return;
  if (drag_mode_ == DragMode::orbit) camera_.orbit(step.x(), step.y());
  if (drag_mode_ == DragMode::look) camera_.look(step.x(), step.y());
  if (drag_mode_ == DragMode::pan) camera_.pan(step.x(), step.y());
}

bool InputController::held_key(int scancode, bool down) {
  const double amount = down ? 1 : 0;
  const auto flipper = [&](unsigned bit) { keys_ = down ? keys_ | bit : keys_ & ~bit; };
  switch (scancode) {
    case SDL_SCANCODE_D:
      flying_.x() = amount;
      return true;
    case SDL_SCANCODE_A:
      flying_.x() = -amount;
      return true;
    case SDL_SCANCODE_E:
      flying_.y() = amount;
      return true;
    case SDL_SCANCODE_Q:
      flying_.y() = -amount;
      return true;
    case SDL_SCANCODE_W:
      flying_.z() = amount;
      return true;
    case SDL_SCANCODE_S:
      flying_.z() = -amount;
      return true;
    case SDL_SCANCODE_LEFT:
    case SDL_SCANCODE_Z:
      flipper(scene::left_key);
      return true;
    case SDL_SCANCODE_RIGHT:
    case SDL_SCANCODE_SLASH:
      flipper(scene::right_key);
      return true;
    default:
      return false;
  }
}

void InputController::key(int scancode, bool down, bool repeated, Settings& settings,
                          InputCommands& commands) {
  if (held_key(scancode, down) || !down) return;
  if (scancode == SDL_SCANCODE_N) single();  // repeats while held
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
      commands.record = true;
      return;
    case SDL_SCANCODE_F12:
      commands.screenshot = true;
      return;
    case SDL_SCANCODE_ESCAPE:
      commands.quit = true;
      return;
    default:
      return;
  }
}

void InputController::update(double seconds, const Settings& settings, session::LiveSession& session,
                             double aspect) {
  const Vec3 sticks(stick_left_.x(), 0, -stick_left_.y());
  if (const Vec3 fly = flying_ + sticks; fly.norm() > 0.01) camera_.fly(0.8 * seconds * fly);
  if (stick_right_.norm() > 0.01)
    camera_.orbit(-0.5 * seconds * stick_right_.x(), 0.5 * seconds * stick_right_.y());
  const Projection projection(camera_.camera(), aspect);
  drag(session, projection);
  if (settings.pen) move_pen(session, projection);
  controls_.paused = settings.paused;
  controls_.speed = std::clamp(settings.speed, 0.01, 1.0);
  controls_.keys = keys_ | shoulders_;
  session.set_controls(controls_);
}

// Drags the body in the camera-facing plane through the grab point.
void InputController::drag(session::LiveSession& session, const Projection& projection) {
  const session::LiveState& state = session.state();
  const Vec3 ray = projection.ray(mouse_position());
  if (std::exchange(pick_pending_, false)) {
    const auto picked = pick_body(session.scene(), {state.pose.data(), state.bodies}, projection.eye, ray);
    const auto floor = pick_floor(*session.surface().surface, false, projection.eye, ray);
    const bool hidden = picked && floor && (*floor - projection.eye).norm() < picked->distance - 0.05;
    if (picked && !hidden && session.is_free(picked->body)) {
      dragging_ = {picked->body, state.pose[picked->body - 1].to_local(picked->point),
                   picked->distance * ray.dot(projection.forward)};
      ++dragged_count_;
    }
  }
  controls_.dragged = dragging_ ? dragging_->body : floor_body;
  if (!dragging_) return;
  controls_.grip = dragging_->grip;
  controls_.pull_to = projection.eye + ray * (dragging_->distance / ray.dot(projection.forward));
}

namespace {

// Where a ray meets a textured surface.
struct SurfacePoint {
  const surface::Surface* surface;
  Vec3 point, normal;
  bool is_curved;
};

// The nearest of the floor, flat grounds and curved grounds along the ray; with `use_relief` flat ones by
// their relief, else by their plane. The floor's plane goes on beyond its rectangle if there are no grounds.
std::optional<SurfacePoint> nearest_surface(const scene::SceneSurface& scene, bool use_relief,
                                            const Vec3& eye, const Vec3& ray) {
  std::optional<SurfacePoint> nearest;
  const auto offer = [&](const SurfacePoint& found) {
    if (!nearest || (found.point - eye).norm() <= (nearest->point - eye).norm()) nearest = found;
  };
  const auto offer_flat = [&](const surface::Surface& surface, bool may_lie_beside) {
    const auto point = pick_floor(surface, use_relief, eye, ray);
    const surface::Placement& place = surface.placement();
    if (point && (may_lie_beside || place.covers(place.to_local(*point))))
      offer({&surface, *point, place.n(), false});
  };
  offer_flat(*scene.surface, scene.grounds.empty());
  for (const scene::SceneSurface& ground : scene.grounds) {
    if (!ground.curved) {
      offer_flat(*ground.surface, false);
    } else if (const auto found = pick_base(ground.curved->base().mesh(), eye, ray)) {
      offer({ground.surface.get(), found->point, found->normal, true});
    }
  }
  return nearest;
}

}  // namespace

// The pen hovers over the surface under the mouse; with the button held it is pressed in, past the relief
// there.
void InputController::move_pen(session::LiveSession& session, const Projection& projection) {
  const bool presses = drag_mode_ == DragMode::press_pen;
  const auto at =
      nearest_surface(session.surface(), !presses, projection.eye, projection.ray(mouse_position()));
  if (!at) return;
  const surface::Placement& place = at->surface->placement();
  const double side = std::max(place.size_u(), place.size_v());
  if (!presses) return session.set_pen_target(at->point + 0.02 * side * at->normal);
  const Vec3 local = place.to_local(at->point);
  const double depth = at->is_curved         ? at->surface->max_depth()
                       : place.covers(local) ? at->surface->depth(place.uv(local))
                                             : 0;
  session.set_pen_target(at->point - (depth + 0.01 * press_depth_ * side) * at->normal);
}

Gamepad::~Gamepad() {
  if (controller_ != nullptr && SDL_WasInit(SDL_INIT_GAMECONTROLLER) != 0)
    SDL_GameControllerClose(controller_);
}

void Gamepad::handle_event(const SDL_Event& event) {
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

Rumble contact_rumble(const session::LiveState& state, std::uint64_t since) {
  Rumble rumble;
  const std::uint64_t oldest =
      state.mark_count > session::max_marks ? state.mark_count - session::max_marks : 0;
  for (std::uint64_t k = std::max(since, oldest); k < state.mark_count; ++k) {
    const session::ContactMark& mark = state.marks[k % session::max_marks];
    const double size = mark.impulse.norm();
    const double strength = std::clamp(1 + std::log10(std::max(size, 1e-9)) / 3, 0.0, 1.0);
    double& motor = mark.begins ? rumble.impact : rumble.slide;
    motor = std::max(motor, mark.begins ? strength : 0.5 * strength);
  }
  return rumble;
}

void Gamepad::rumble(const session::LiveState& state) {
  const Rumble rumble = contact_rumble(state, rumbled_marks_);
  rumbled_marks_ = state.mark_count;
  if (controller_ == nullptr || (rumble.impact <= 0 && rumble.slide <= 0)) return;
  const auto motor = [](double x) { return Uint16(65535 * std::clamp(x, 0.0, 1.0)); };
  SDL_GameControllerRumble(controller_, motor(rumble.impact), motor(rumble.slide), 60);
}

}  // namespace intaglio::window
