#include "window/script.h"

#include <SDL2/SDL.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "haptics/vrpn/client.h"
#include "intaglio/error.h"
#include "window/settings.h"

namespace intaglio::window {

namespace {

struct Number {
  double low, high;
  bool is_integer;
};
constexpr Number unbounded{-1e9, 1e9, false}, unit_range{0, 1, false};

struct VerbSpec {
  const char* name;
  ScriptVerb verb;
  const char* arguments;  // t: the rest as text, w: a word, n: a number
  const char* usage;
  std::array<Number, 2> numbers = {unbounded, unbounded};
};
constexpr std::array<VerbSpec, 14> forms = {{
    {"key", ScriptVerb::key, "t", "key NAME"},
    {"hold", ScriptVerb::hold, "t", "hold NAME"},
    {"release", ScriptVerb::release, "t", "release NAME"},
    {"move", ScriptVerb::move, "nn", "move X Y", {unit_range, unit_range}},
    {"point", ScriptVerb::point, "n", "point BODY", {Number{0, 1e6, true}, unbounded}},
    {"down", ScriptVerb::down, "w", "down left|middle|right"},
    {"up", ScriptVerb::up, "w", "up left|middle|right"},
    {"wheel", ScriptVerb::wheel, "n", "wheel NOTCHES", {Number{-100, 100, true}, unbounded}},
    {"drop", ScriptVerb::drop, "t", "drop FILE"},
    {"resize", ScriptVerb::resize, "nn", "resize W H", {Number{16, 7680, true}, Number{16, 4320, true}}},
    {"set", ScriptVerb::set, "wn", "set NAME VALUE"},
    {"device", ScriptVerb::device, "w", "device NAME@HOST|mouse"},
    {"screenshot", ScriptVerb::screenshot, "t", "screenshot FILE"},
    {"quit", ScriptVerb::quit, "", "quit"},
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

Result<void> check_number(const VerbSpec& form, std::size_t k, double value) {
  const Number& n = form.numbers[k];
  if (value >= n.low && value <= n.high && (!n.is_integer || value == std::floor(value))) return {};
  return fail("", fmt::format("\"{}\": {} is out of range", form.name, value),
              fmt::format("{}: {} from {} to {}", form.usage, n.is_integer ? "an integer" : "a number", n.low,
                          n.high));
}

// Checks what can be checked of an event's arguments before it is due.
Result<void> check_event(const VerbSpec& form, const ScriptEvent& event) {
  if (auto x = check_number(form, 0, event.x); !x) return x;
  if (auto y = check_number(form, 1, event.y); !y) return y;
  switch (event.verb) {
    case ScriptVerb::key:
    case ScriptVerb::hold:
    case ScriptVerb::release:
      if (SDL_GetScancodeFromName(event.text.c_str()) != SDL_SCANCODE_UNKNOWN) return {};
      return fail("", fmt::format("unknown key \"{}\"", event.text), "use SDL key names: Space, R, F9, Left");
    case ScriptVerb::down:
    case ScriptVerb::up:
      if (event.text == "left" || event.text == "middle" || event.text == "right") return {};
      return fail("", fmt::format("unknown mouse button \"{}\"", event.text), "left, middle or right");
    case ScriptVerb::set:
      return check_setting(event.text, event.x);
    case ScriptVerb::device: {
      if (event.text == "mouse") return {};
      const auto address = haptics::vrpn::parse_address(event.text);
      return address ? Result<void>() : tl::unexpected(address.error());
    }
    case ScriptVerb::screenshot:
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
    event.where = where;
    std::istringstream seconds(time);
    if (!(seconds >> event.time) || !seconds.eof() || !(event.time >= 0) || event.time > 1e5)
      return fail(where, fmt::format("\"{}\" is not a time", time),
                  "a line is TIME VERB ARGUMENTS, seconds from 0 on");
    if (!events.empty() && event.time < events.back().time)
      return fail(where, "is earlier than the line before", "times must not decrease from line to line");
    words >> verb;
    const VerbSpec* form = nullptr;
    std::vector<std::string> names;
    for (const VerbSpec& f : forms) {
      if (verb == f.name) form = &f;
      names.emplace_back(f.name);
    }
    if (form == nullptr) {
      const std::string nearest = nearest_name(verb, names);
      return fail(where, fmt::format("unknown event \"{}\"", verb),
                  nearest.empty() ? "docs/run.md lists them" : fmt::format("did you mean \"{}\"?", nearest));
    }
    event.verb = form->verb;
    if (!read_arguments(words, form->arguments, event))
      return fail(where, fmt::format("\"{}\" has wrong arguments", verb),
                  fmt::format("write: {} {}", time, form->usage));
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
                        const LocateBody& locate) {
  screenshot_.clear();
  if (!started_) start_ = std::chrono::steady_clock::now();
  started_ = true;
  const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  while (next_ < events_.size() && events_[next_].time <= now) {
    const ScriptEvent& event = events_[next_];
    push(event, window, settings, messages, locate);
    ++next_;
    // A press and the event after it must fall in different frames.
    if (event.verb != ScriptVerb::set && event.verb != ScriptVerb::hold && event.verb != ScriptVerb::release)
      return;
  }
}

void ScriptPlayer::move_mouse(const Vec2& place, const SdlWindow& window) {
  const WindowSize size = window.size();
  const int x = int(std::lround(place.x() * size.window_width));
  const int y = int(std::lround(place.y() * size.window_height));
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

void ScriptPlayer::press_button(int button, bool down) {
  const auto mask = unsigned(SDL_BUTTON(button));
  buttons_ = down ? buttons_ | mask : buttons_ & ~mask;
  SDL_Event pushed{};
  pushed.type = down ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP;
  pushed.button.button = Uint8(button);
  pushed.button.state = down ? SDL_PRESSED : SDL_RELEASED;
  pushed.button.clicks = 1;
  pushed.button.x = x_;
  pushed.button.y = y_;
  SDL_PushEvent(&pushed);
}

void ScriptPlayer::push(const ScriptEvent& event, SdlWindow& window, Settings& settings,
                        std::vector<std::string>& messages, const LocateBody& locate) {
  SDL_Event pushed{};
  switch (event.verb) {
    case ScriptVerb::key:
    case ScriptVerb::hold:
    case ScriptVerb::release: {
      const SDL_Scancode code = SDL_GetScancodeFromName(event.text.c_str());
      if (event.verb != ScriptVerb::release) push_key(code, true);
      if (event.verb != ScriptVerb::hold) push_key(code, false);
      return;
    }
    case ScriptVerb::move:
      return move_mouse({event.x, event.y}, window);
    case ScriptVerb::point:
      if (const auto place = locate(std::size_t(event.x))) {
        move_mouse(*place, window);
      } else {
        messages.push_back(with_where(event.where, place.error()).message());
      }
      return;
    case ScriptVerb::down:
    case ScriptVerb::up:
      return press_button(button_of(event.text), event.verb == ScriptVerb::down);
    case ScriptVerb::wheel:
      pushed.type = SDL_MOUSEWHEEL;
      pushed.wheel.y = int(std::lround(event.x));
      break;
    case ScriptVerb::drop:
      pushed.type = SDL_DROPFILE;
      pushed.drop.file = SDL_strdup(event.text.c_str());
      break;
    case ScriptVerb::resize:
      window.resize(int(event.x), int(event.y));
      return;
    case ScriptVerb::set:
      if (const auto set = set_by_name(settings, event.text, event.x); !set)
        messages.push_back(with_where(event.where, set.error()).message());
      return;
    case ScriptVerb::device:
      settings.device = event.text == "mouse" ? "" : event.text;
      settings.device_source = event.where;
      return;
    case ScriptVerb::screenshot:
      screenshot_ = event.text;
      return;
    case ScriptVerb::quit:
      pushed.type = SDL_QUIT;
      break;
  }
  SDL_PushEvent(&pushed);
}

}  // namespace intaglio::window
