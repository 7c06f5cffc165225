#include "scene/cues.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <system_error>
#include <utility>

#include "core/text.h"

namespace intaglio::scene {

namespace {

// A name of a fault list and the cues that it stands for.
struct CueGroup {
  std::string_view name;
  std::vector<Cue> cues;
};

const std::vector<CueGroup>& cue_groups() {
  static const std::vector<CueGroup> groups = {
      {"picture", {Cue::picture}},
      {"touch", {Cue::touch}},
      {"pen_sound", {Cue::pen_sound}},
      {"ball_motion", {Cue::ball_motion}},
      {"ball_sound", {Cue::ball_sound}},
      {"sound", {Cue::pen_sound, Cue::ball_sound}},
      {"motion", {Cue::ball_motion}},
      {"ball", {Cue::ball_motion, Cue::ball_sound}},
      {"all", {all_cues.begin(), all_cues.end()}},
  };
  return groups;
}

const CueGroup* find_cue_group(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  for (const CueGroup& group : cue_groups())
    if (group.name == name) return &group;
  return nullptr;
}

std::string cue_group_names() {
  std::string names;
  for (const CueGroup& group : cue_groups()) names += (names.empty() ? "" : ", ") + std::string(group.name);
  return names;
}

std::string_view without_spaces(std::string_view text) {
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

// Text of the user's in a message: printable and not long.
std::string shown(std::string_view text) {
  constexpr std::size_t most = 60;
  return printable(std::string(text.substr(0, most))) + (text.size() > most ? "..." : "");
}

// Units of a quantity: `per` of them are one SI unit.
struct Unit {
  std::string_view name;
  double per;
};
constexpr std::array<Unit, 2> time_units = {{{"ms", 1000}, {"s", 1}}};
constexpr std::array<Unit, 3> length_units = {{{"mm", 1000}, {"cm", 100}, {"m", 1}}};

const Unit* find_unit(std::string_view name, std::span<const Unit> units) {
  const auto found =
      std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return unit.name == name; });
  return found == units.end() ? nullptr : &*found;
}

// A number at the start of `text`, which is shortened by it.
std::optional<double> take_number(std::string_view& text) {
  text = without_spaces(text);
  if (text.starts_with('+') && !text.substr(1).starts_with('-')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(std::size_t(end - text.data()));
  text = without_spaces(text);
  return value;
}

// One or two numbers with a unit each, or one unit for both: 10mm, 3x4mm, 3mm x 0.4cm.
struct Quantity {
  std::vector<double> numbers;  // SI
};
constexpr const char* delay_form = "for example 60ms or 0.06s";
constexpr const char* shift_form = "for example 10mm or 1cm along u, 3x-4mm along u and v";

Result<Quantity> parse_quantity(std::string_view text, std::span<const Unit> units, std::size_t most,
                                const char* form) {
  std::vector<std::pair<double, std::string_view>> parts;
  while (true) {
    const auto number = take_number(text);
    if (!number)
      return fail("", text.empty() ? "a number is missing" : shown(text) + " is not a number", form);
    const auto end = std::min(text.find('x'), text.size());
    parts.emplace_back(*number, without_spaces(text.substr(0, end)));
    if (end == text.size()) break;
    if (parts.size() == most)
      return fail("", most == 1 ? "has two numbers where one is wanted" : "has more than two numbers", form);
    text.remove_prefix(end + 1);
  }
  Quantity quantity;
  for (const auto& [number, own] : parts) {
    const std::string_view name = own.empty() ? parts.back().second : own;
    if (name.empty()) return fail("", "has no unit", form);
    const Unit* const unit = find_unit(name, units);
    if (unit == nullptr) return fail("", "there is no unit \"" + shown(name) + "\" here", form);
    quantity.numbers.push_back(number / unit->per);
  }
  return quantity;
}

Result<void> set_delay(std::string_view text, std::vector<CueSettings*>& cues) {
  const auto delay = parse_quantity(text, time_units, 1, delay_form);
  if (!delay) return tl::unexpected(delay.error());
  const double seconds = delay->numbers[0];
  if (seconds < 0)
    return fail("", "a delay is negative: no sense can be early",
                "delay the others instead, for example all-delay=60ms,sound-delay=0ms");
  if (seconds > max_cue_delay)
    return fail("", fmt::format("a delay of {:g} s is too long", seconds),
                fmt::format("at most {:g} s", max_cue_delay));
  for (CueSettings* cue : cues) cue->delay = seconds + 0.0;  // no negative zero
  return {};
}

Result<void> set_shift(std::string_view text, std::vector<CueSettings*>& cues) {
  const auto shift = parse_quantity(text, length_units, 2, shift_form);
  if (!shift) return tl::unexpected(shift.error());
  Vec2 metres = Vec2::Zero();
  for (std::size_t k = 0; k < shift->numbers.size(); ++k) metres[Eigen::Index(k)] = shift->numbers[k] + 0.0;
  if (metres.cwiseAbs().maxCoeff() > max_cue_shift)
    return fail("", fmt::format("a shift of {:g} m is too far", metres.cwiseAbs().maxCoeff()),
                fmt::format("between -{0:g} m and {0:g} m", max_cue_shift));
  for (CueSettings* cue : cues) cue->shift = metres;
  return {};
}

Result<void> set_value(const std::string& name, std::string_view value, std::vector<CueSettings*>& cues) {
  const std::string word = lower_case(std::string(value));
  if (value.empty()) return fail("", "has no value", "off, on or a texture");
  if (word == "on" || word == "off") {
    for (CueSettings* cue : cues) cue->on = word == "on";
    return {};
  }
  for (const auto& [units, property] : {std::pair(std::span<const Unit>(time_units), "delay"),
                                        std::pair(std::span<const Unit>(length_units), "shift")})
    if (parse_quantity(value, units, 2, ""))
      return fail("", shown(value) + " is not a texture",
                  fmt::format("did you mean {}-{}={}? (a texture of that name: ./{})", name, property,
                              shown(value), shown(value)));
  for (CueSettings* cue : cues) {
    cue->texture = std::string(value);
    cue->line = fmt::format("{}={}", name, shown(value));
  }
  return {};
}

Error no_such_cue(std::string_view name) {
  std::vector<std::string_view> names;
  for (const CueGroup& group : cue_groups()) names.push_back(group.name);
  const std::string near = nearest_name(std::string(name.substr(0, 60)), names);
  return {"", "there is no cue \"" + shown(name) + "\"",
          near.empty() ? "one of " + cue_group_names() : "did you mean " + near + "?"};
}

// A part NAME=VALUE or NAME-PROPERTY=VALUE; errors without a place.
Result<void> add_fault(Cues& cues, std::string_view part) {
  if (part.empty()) return fail("", "an empty part", "for example sound-delay=60ms,picture=off");
  const auto equals = part.find('=');
  const std::string key(without_spaces(part.substr(0, equals)));
  const std::string_view value =
      equals == std::string_view::npos ? std::string_view() : without_spaces(part.substr(equals + 1));
  std::string property;
  const CueGroup* group = find_cue_group(key);
  if (group == nullptr) {
    const auto dash = key.rfind('-');
    group = find_cue_group(key.substr(0, dash));
    if (group == nullptr) {
      const bool has_property =
          dash != std::string::npos && (key.ends_with("-delay") || key.ends_with("-shift"));
      return tl::unexpected(no_such_cue(has_property ? key.substr(0, dash) : key));
    }
    property = key.substr(dash + 1);
  }
  const std::string name(group->name);
  if (equals == std::string_view::npos)
    return fail("", "has no value",
                fmt::format("{0}=off, {0}-delay=60ms, {0}-shift=10mm or {0}=TEXTURE", name));
  std::vector<CueSettings*> chosen;
  for (const Cue cue : group->cues) chosen.push_back(&cues[cue]);
  if (property.empty()) return set_value(name, value, chosen);
  if (property == "delay") return set_delay(value, chosen);
  if (property == "shift") return set_shift(value, chosen);
  const std::string near = nearest_name(property.substr(0, 60), std::array{"delay", "shift"});
  return fail("", "a cue has no \"" + shown(property) + "\"",
              near.empty() ? fmt::format("{0}-delay or {0}-shift", name)
                           : fmt::format("did you mean {}-{}?", name, near));
}

}  // namespace

const char* name_of(Cue cue) {
  constexpr std::array names = {"picture", "touch", "pen_sound", "ball_motion", "ball_sound"};
  return names[std::size_t(cue)];
}

CueSettings& Cues::operator[](Cue cue) {
  switch (cue) {
    case Cue::touch:
      return touch;
    case Cue::pen_sound:
      return pen_sound;
    case Cue::ball_motion:
      return ball_motion;
    case Cue::ball_sound:
      return ball_sound;
    default:
      return picture;
  }
}

bool Cues::are_true() const {
  return std::all_of(all_cues.begin(), all_cues.end(), [this](Cue cue) { return (*this)[cue].is_true(); });
}

bool share_surfaces(const Cues& a, const Cues& b) {
  const auto equal = [&](Cue cue) {
    return a[cue].texture == b[cue].texture && a[cue].shift == b[cue].shift;
  };
  return a.picture.on == b.picture.on && std::all_of(all_cues.begin(), all_cues.end(), equal);
}

Result<void> add_faults(Cues& cues, std::string_view text) {
  Cues changed = cues;
  while (true) {
    const auto comma = text.find(',');
    const std::string_view part = without_spaces(text.substr(0, comma));
    if (const auto added = add_fault(changed, part); !added)
      return tl::unexpected(with_where(part.empty() ? "faults" : shown(part), added.error()));
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  cues = std::move(changed);
  return {};
}

namespace {

// "60ms", or "0.0123456789s" where milliseconds would not give the same number back.
std::string quantity_text(double si, double per, std::string_view small, std::string_view large) {
  const double scaled = std::round(1e6 * si * per) / 1e6;
  return scaled / per == si ? fmt::format("{}{}", scaled, small) : fmt::format("{}{}", si, large);
}

std::string faults_of(std::string_view name, const CueSettings& cue) {
  std::string text;
  const auto add = [&](const std::string& part) {
    text += fmt::format("{}{}{}", text.empty() ? "" : ",", name, part);
  };
  if (!cue.on) add("=off");
  if (cue.delay != 0) add("-delay=" + quantity_text(cue.delay, 1000, "ms", "s"));
  const std::string u = quantity_text(cue.shift.x(), 1000, "mm", "m");
  if (cue.shift != Vec2::Zero())
    add("-shift=" + (cue.shift.y() == 0 ? u : u + "x" + quantity_text(cue.shift.y(), 1000, "mm", "m")));
  if (cue.texture) add("=" + *cue.texture);
  return text;
}

// Settings with what each applies to; sounds that are alike are one.
template <class Use>
void for_each_distinct(const Cues& cues, const Use& use) {
  const bool sounds_alike = cues.pen_sound == cues.ball_sound;
  use("picture", "picture", cues.picture);
  use("touch", "touch", cues.touch);
  if (sounds_alike) {
    use("sound", "sound", cues.pen_sound);
  } else {
    use("pen_sound", "the pen's sound", cues.pen_sound);
    use("ball_sound", "the bodies' sound", cues.ball_sound);
  }
  use("motion", "motion", cues.ball_motion);
}

}  // namespace

std::string fault_text(const Cues& cues) {
  std::string text;
  for_each_distinct(cues, [&](std::string_view name, std::string_view, const CueSettings& cue) {
    const std::string faults = faults_of(name, cue);
    if (!faults.empty()) text += (text.empty() ? "" : ",") + faults;
  });
  return text;
}

std::vector<std::string> cue_changes(const Cues& cues) {
  std::vector<std::string> changes;
  for_each_distinct(cues, [&](std::string_view, std::string_view sense, const CueSettings& cue) {
    const auto add = [&](const std::string& change) {
      changes.push_back(fmt::format("{} {}", sense, change));
    };
    if (!cue.on) add("off");
    if (cue.delay != 0) add(fmt::format("late by {:.6g} ms", 1000 * cue.delay));
    if (cue.texture) add("of " + printable(*cue.texture));
    const Vec2 mm = 1000 * cue.shift;
    if (mm.x() != 0 && mm.y() != 0) {
      add(fmt::format("shifted by {:.6g} mm along u and {:.6g} mm along v", mm.x(), mm.y()));
    } else if (mm != Vec2::Zero()) {
      add(mm.y() == 0 ? fmt::format("shifted by {:.6g} mm along u", mm.x())
                      : fmt::format("shifted by {:.6g} mm along v", mm.y()));
    }
  });
  return changes;
}

std::string cue_note(const Cues& cues) {
  std::string note;
  for (const std::string& change : cue_changes(cues)) note += (note.empty() ? "cues: " : ", ") + change;
  return note;
}

}  // namespace intaglio::scene
