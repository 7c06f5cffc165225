#include "intaglio/window/script_player.h"

#include <SDL2/SDL.h>

#include <algorithm>
#include <cmath>

#include "intaglio/core/nested_error.h"

namespace intaglio::window {

namespace {

int button_of(const std::string& name) {
  return name == "left" ? SDL_BUTTON_LEFT : name == "right" ? SDL_BUTTON_RIGHT : SDL_BUTTON_MIDDLE;
}

void push_key(SDL_Scancode code, bool down) {
  SDL_Event event{};
  event.type = down ? SDL_KEYDOWN : SDL_KEYUP;
  event.key.state = down ? SDL_PRESSED : SDL_RELEASED;
  event.key.keysym.scancode = code;
  event.key.keysym.sym = SDL_GetKeyFromScancode(code);
  SDL_PushEvent(&event);
}

}  // namespace

void ScriptPlayer::play(SdlWindow& window, Settings& settings, std::vector<std::string>& messages,
                        const Where& where) {
  screenshot_.clear();
  if (!started_) start_ = std::chrono::steady_clock::now();
  started_ = true;
  const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  while (next_ < events_.size() && events_[next_].time <= now) {
    const ScriptEvent& event = events_[next_];
    push(event, window, settings, messages, where);
    ++next_;
    // A press and what comes after it must not be seen in one picture.
    if (event.verb != Verb::set && event.verb != Verb::hold && event.verb != Verb::release) return;
  }
}

void ScriptPlayer::move_mouse(const Vec2& place, const SdlWindow& window) {
  const WindowSize size = window.size();
  const int x = static_cast<int>(std::lround(place.x() * size.window_width));
  const int y = static_cast<int>(std::lround(place.y() * size.window_height));
  SDL_Event pushed{};
  pushed.type = SDL_MOUSEMOTION;
  pushed.motion.state = buttons_;
  pushed.motion.x = x;
  pushed.motion.y = y;
  pushed.motion.xrel = x - x_;
  pushed.motion.yrel = y - y_;
  x_ = x;
  y_ = y;
  SDL_PushEvent(&pushed);
}

void ScriptPlayer::push(const ScriptEvent& event, SdlWindow& window, Settings& settings,
                        std::vector<std::string>& messages, const Where& where) {
  SDL_Event pushed{};
  switch (event.verb) {
    case Verb::key:
    case Verb::hold:
    case Verb::release: {
      const SDL_Scancode code = SDL_GetScancodeFromName(event.text.c_str());
      if (event.verb != Verb::release) push_key(code, true);
      if (event.verb != Verb::hold) push_key(code, false);
      return;
    }
    case Verb::move:
      return move_mouse({event.x, event.y}, window);
    case Verb::point:
      if (const auto place = where(static_cast<std::size_t>(event.x))) {
        move_mouse(*place, window);
      } else {
        messages.push_back(with_where(event.where, place.error()).message());
      }
      return;
    case Verb::down:
    case Verb::up: {
      const int button = button_of(event.text);
      const auto mask = static_cast<unsigned>(SDL_BUTTON(button));
      const bool down = event.verb == Verb::down;
      buttons_ = down ? buttons_ | mask : buttons_ & ~mask;
      pushed.type = down ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP;
      pushed.button.button = static_cast<Uint8>(button);
      pushed.button.state = down ? SDL_PRESSED : SDL_RELEASED;
      pushed.button.clicks = 1;
      pushed.button.x = x_;
      pushed.button.y = y_;
      break;
    }
    case Verb::wheel:
      pushed.type = SDL_MOUSEWHEEL;
      pushed.wheel.y = static_cast<int>(std::lround(event.x));
      break;
    case Verb::drop:
      pushed.type = SDL_DROPFILE;
      pushed.drop.file = SDL_strdup(event.text.c_str());
      break;
    case Verb::resize:
      window.resize(static_cast<int>(event.x), static_cast<int>(event.y));
      return;
    case Verb::set:
      if (const auto set = set_by_name(settings, event.text, event.x); !set)
        messages.push_back(with_where(event.where, set.error()).message());
      return;
    case Verb::device:
      settings.device = event.text == "mouse" ? "" : event.text;
      settings.device_from = event.where;
      return;
    case Verb::screenshot:
      screenshot_ = event.text;
      return;
    case Verb::quit:
      pushed.type = SDL_QUIT;
      break;
  }
  SDL_PushEvent(&pushed);
}

}  // namespace intaglio::window
