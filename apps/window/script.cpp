#include "window/script.h"

#include <SDL2/SDL.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"
#include "haptics/vrpn/client.h"
#include "intaglio/error.h"
#include "window/settings.h"

namespace intaglio::window {

namespace {

struct Number {
  double low, high;
  bool is_whole;
};
constexpr Number any{-1e9, 1e9, false}, part{0, 1, false};  // part: of the window

struct VerbForm {
  const char* name;
  Verb verb;
  const char* arguments;  // t: the rest as text, w: a word, n: a number
  const char* says;
  std::array<Number, 2> numbers = {any, any};
};
constexpr std::array<VerbForm, 14> forms = {{
    {"key", Verb::key, "t", "key NAME"},
    {"hold", Verb::hold, "t", "hold NAME"},
    {"release", Verb::release, "t", "release NAME"},
    {"move", Verb::move, "nn", "move X Y", {part, part}},
    {"point", Verb::point, "n", "point BODY", {Number{0, 1e6, true}, any}},
    {"down", Verb::down, "w", "down left|middle|right"},
    {"up", Verb::up, "w", "up left|middle|right"},
    {"wheel", Verb::wheel, "n", "wheel NOTCHES", {Number{-100, 100, true}, any}},
    {"drop", Verb::drop, "t", "drop FILE"},
    {"resize", Verb::resize, "nn", "resize W H", {Number{16, 7680, true}, Number{16, 4320, true}}},
    {"set", Verb::set, "wn", "set NAME VALUE"},
    {"device", Verb::device, "w", "device NAME@HOST|mouse"},
    {"screenshot", Verb::screenshot, "t", "screenshot FILE"},
    {"quit", Verb::quit, "", "quit"},
}};

bool read_arguments(std::istringstream& words, const char* arguments, ScriptEvent& event) {
  double* numbers[] = {&event.x, &event.y};
  int count = 0;
  for (const char* kind = arguments; *kind != 0; ++kind) {
    if (*kind == 'n') {
      double& number = *numbers[count++];
      if (!(words >> number) || !std::isfinite(number)) return false;
    } else if (*kind == 'w') {
      if (!(words >> event.text)) return false;
    } else {
      std::getline(words >> std::ws, event.text);
      while (!event.text.empty() && (event.text.back() == ' ' || event.text.back() == '\r'))
        event.text.pop_back();
      if (event.text.empty()) return false;
    }
  }
  std::string more;
  return !(words >> more);
}

Result<void> check_number(const VerbForm& form, std::size_t k, double value) {
  const Number& n = form.numbers[k];
  if (value >= n.low && value <= n.high && (!n.is_whole || value == std::floor(value))) return {};
  return fail("", fmt::format("\"{}\" has {}", form.name, value),
              fmt::format("{}: {} from {} to {}", form.says, n.is_whole ? "a whole number" : "a number",
                          n.low, n.high));
}

// What can be known of an event's arguments before it is due.
Result<void> check_event(const VerbForm& form, const ScriptEvent& event) {
  if (auto x = check_number(form, 0, event.x); !x) return x;
  if (auto y = check_number(form, 1, event.y); !y) return y;
  switch (event.verb) {
    case Verb::key:
    case Verb::hold:
    case Verb::release:
      if (SDL_GetScancodeFromName(event.text.c_str()) != SDL_SCANCODE_UNKNOWN) return {};
      return fail("", fmt::format("there is no key \"{}\"", event.text),
                  "SDL's names are wanted: Space, R, F9, Left");
    case Verb::down:
    case Verb::up:
      if (event.text == "left" || event.text == "middle" || event.text == "right") return {};
      return fail("", fmt::format("there is no mouse button \"{}\"", event.text), "left, middle or right");
    case Verb::set:
      return check_setting(event.text, event.x);
    case Verb::device: {
      if (event.text == "mouse") return {};
      const auto address = haptics::vrpn::parse_address(event.text);
      return address ? Result<void>() : tl::unexpected(address.error());
    }
    case Verb::screenshot:
      return check_named(event.text, ".png", "a picture");
    default:
      return {};
  }
}

}  // namespace

Result<std::vector<ScriptEvent>> parse_script(std::string_view text, const std::string& name) {
  std::vector<ScriptEvent> events;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    line = line.substr(0, line.find('#'));
    std::istringstream words(line);
    std::string time, verb;
    if (!(words >> time)) continue;
    const std::string where = fmt::format("{}:{}", name, number);
    ScriptEvent event;
    event.line = number;
    event.where = where;
    std::istringstream seconds(time);
    if (!(seconds >> event.time) || !seconds.eof() || !(event.time >= 0) || event.time > 1e5)
      return fail(where, fmt::format("\"{}\" is no time", time),
                  "a line is TIME VERB ARGUMENTS, seconds from 0 on");
    if (!events.empty() && event.time < events.back().time)
      return fail(where, "goes back in time", "times must not decrease from line to line");
    words >> verb;
    const VerbForm* form = nullptr;
    std::vector<std::string> names;
    for (const VerbForm& f : forms) {
      if (verb == f.name) form = &f;
      names.emplace_back(f.name);
    }
    if (form == nullptr) {
      const std::string nearest = nearest_name(verb, names);
      return fail(where, fmt::format("there is no event \"{}\"", verb),
                  nearest.empty() ? "docs/run.md lists them" : fmt::format("did you mean \"{}\"?", nearest));
    }
    event.verb = form->verb;
    if (!read_arguments(words, form->arguments, event))
      return fail(where, fmt::format("\"{}\" has wrong arguments", verb),
                  fmt::format("write: {} {}", time, form->says));
    if (const auto checked = check_event(*form, event); !checked)
      return tl::unexpected(with_where(where, checked.error()));
    events.push_back(std::move(event));
  }
  return events;
}

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
