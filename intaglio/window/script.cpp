#include "intaglio/window/script.h"

#include <array>
#include <cmath>
#include <sstream>

namespace intaglio::window {

namespace {

struct VerbForm {
  const char* name;
  Verb verb;
  const char* arguments;  // t: the rest as text, w: a word, n: a number
  const char* says;
};
constexpr std::array<VerbForm, 14> forms = {{
    {"key", Verb::key, "t", "key NAME"},
    {"hold", Verb::hold, "t", "hold NAME"},
    {"release", Verb::release, "t", "release NAME"},
    {"move", Verb::move, "nn", "move X Y"},
    {"point", Verb::point, "n", "point BODY"},
    {"down", Verb::down, "w", "down left|middle|right"},
    {"up", Verb::up, "w", "up left|middle|right"},
    {"wheel", Verb::wheel, "n", "wheel NOTCHES"},
    {"drop", Verb::drop, "t", "drop FILE"},
    {"resize", Verb::resize, "nn", "resize W H"},
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
    if ((event.verb == Verb::down || event.verb == Verb::up) && event.text != "left" &&
        event.text != "middle" && event.text != "right")
      return fail(where, fmt::format("there is no mouse button \"{}\"", event.text), "left, middle or right");
    events.push_back(std::move(event));
  }
  return events;
}

}  // namespace intaglio::window
