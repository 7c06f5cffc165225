#include "study/design/design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "core/file.h"
#include "core/text.h"
#include "core/toml.h"
#include "study/design/design_reader.h"
#include "study/store/sha256.h"

namespace intaglio::study {

namespace {

constexpr std::size_t most_text = 20'000;

template <class List>
auto* find_named(List& list, std::string_view name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
  return found == list.end() ? nullptr : &*found;
}

bool is_name(std::string_view name) {
  return !name.empty() && name.size() <= 40 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

// A table of texts: any key that is a name.
void read_texts(TomlReader& r, const char* key, std::map<std::string, std::string>& texts) {
  const toml::node* node = r.node(key);
  if (node == nullptr) return;
  if (!node->is_table())
    return r.fail_at(key, "texts are a table", "[texts], with a line KEY = \"text\" each");
  for (const auto& [name, value] : *node->as_table()) {
    const std::string text = value.value_or(std::string());
    if (!is_name(name.str()))
      return r.fail_at(value, "a text's key is no name", "1 to 40 letters, digits, _ and -");
    if (!value.is_string())
      return r.fail_at(value, fmt::format("text {} is no string", name.str()), "a quoted string is required");
    if (text.size() > most_text)
      return r.fail_at(value, fmt::format("text {} has {} bytes", name.str(), text.size()),
                       fmt::format("at most {}", most_text));
    if (texts.size() >= most_texts)
      return r.fail_at(value, "too many texts", fmt::format("at most {}", most_texts));
    texts[std::string(name.str())] = text;
  }
}

// Appends what a [[key]] table says, within a bound; names must differ.
template <class Item, class Read>
void read_list(TomlReader& r, const char* key, std::size_t most, std::vector<Item>& list, const Read& read) {
  r.tables(key, [&](TomlReader& t) {
    if (t.has_failed()) return;
    if (list.size() >= most)
      return t.fail_at("name", fmt::format("there are too many [[{}]]", key),
                       fmt::format("at most {}", most));
    Item item;
    read(t, item);
    if (find_named(list, item.name) != nullptr)
      t.fail_at("name", fmt::format("there are two [[{}]] \"{}\"", key, printable(item.name)),
                "each needs a name of its own");
    list.push_back(std::move(item));
  });
}

void read_materials(TomlReader& r, std::vector<StudyMaterial>& materials) {
  read_list(r, "material", most_materials, materials, [](TomlReader& t, StudyMaterial& material) {
    read_name(t, "name", material.name);
    std::string texture = material.name;
    t.string("texture", texture);
    t.string("label", material.label);
    t.string("family", material.family);
    material.set.put("surface.texture", toml_quoted(texture));
    Overrides more;
    more.read(t, "set");
    material.set.put_all(more);
  });
}

void read_factors(TomlReader& r, Design& design) {
  read_list(r, "factor", most_factors, design.factors, [&](TomlReader& t, Factor& factor) {
    read_name(t, "name", factor.name);
    t.choice("assign", {"cross", "split"}, factor.assign);
    read_list(t, "level", most_levels, factor.levels, [&](TomlReader& l, Level& level) {
      read_name(l, "name", level.name);
      read_text_key(l, "say", design, level.say);
      level.set.read(l, "set");
      level.line = l.line_of("set");
    });
    if (factor.levels.empty())
      t.fail_at("name", "factor " + factor.name + " has no level", "give [[factor.level]] tables");
  });
}

void read_devices(TomlReader& r, Devices& devices) {
  r.table("devices", [&](TomlReader& t) {
    t.choice("pen", {"any", "mouse", "vrpn", "gamepad"}, devices.pen);
    t.boolean("force", devices.needs_force);
    t.boolean("sound", devices.needs_sound);
    t.boolean("calibration", devices.needs_calibration);
  });
}

void read_seed(TomlReader& r, std::uint64_t& seed) {
  double value = double(seed);
  r.number("seed", value, {0, 1e15, false, "a seed must be an integer from 0 to 1e15"});
  if (value != std::floor(value)) r.fail_at("seed", "the seed is no integer", "an integer from 0 to 1e15");
  seed = std::uint64_t(value);
}

void read_languages(TomlReader& r, Design& design) {
  read_name(r, "language", design.language);
  read_texts(r, "texts", design.texts[design.language]);
  std::map<std::string, std::string> files;
  read_texts(r, "languages", files);
  if (files.size() > most_languages || files.count(design.language) > 0)
    r.fail_at("languages", "it names the design's own language, or too many",
              fmt::format("others than \"{}\", at most {}", design.language, most_languages));
  design.language_files = std::move(files);
}

void read_consent(TomlReader& r, Design& design) {
  r.table("consent", [&](TomlReader& t) {
    Consent& consent = design.consent.emplace();
    t.string("version", consent.version);
    read_text_key(t, "text", design, consent.text);
    if (consent.version.empty() || consent.version.size() > 40 || consent.text.empty())
      t.fail_at("version", "a consent needs a version and a text",
                "for example version = \"2\", text = \"consent\"");
  });
}

void read_stop(TomlReader& r, StopRule& stop) {
  r.table("stop", [&](TomlReader& t) {
    t.integer("participants", stop.participants,
              {1, most_participants, false, "between 1 and 10000 participants"});
    t.number("session_minutes", stop.session_minutes, {1, 600, false, "between 1 and 600 minutes"});
  });
}

void check_whole(TomlReader& r, const Design& design) {
  if (r.has_failed()) return;
  if (design.steps.empty())
    return r.fail_at("title", "the design has no [[step]]", "what does a participant go through?");
  const bool has_consent = std::any_of(design.steps.begin(), design.steps.end(),
                                       [](const StepDesign& step) { return step.kind == StepKind::consent; });
  std::size_t trials = 0;
  for (const StepDesign& step : design.steps) trials += std::size_t(step.trials);
  if (trials > most_session_trials)
    r.fail_at("step", fmt::format("a session would have {} trials", trials),
              fmt::format("at most {}", most_session_trials));
  if (has_consent != design.consent.has_value())
    r.fail_at("consent", "a [consent] and a step of kind \"consent\" go together",
              has_consent ? "give [consent] with its version and text" : "add a [[step]] kind = \"consent\"");
}

}  // namespace

const char* name_of(StepKind kind) {
  constexpr const char* names[] = {"consent", "instructions", "preview",       "practice",
                                   "block",   "break",        "questionnaire", "end"};
  return names[int(kind)];
}

const StudyMaterial* Design::find_material(std::string_view of) const {
  return find_named(materials, of);
}
const Factor* Design::find_factor(std::string_view of) const {
  return find_named(factors, of);
}
const Question* Design::find_question(std::string_view of) const {
  return find_named(questions, of);
}

const std::string& Design::text(const std::string& key, const std::string& in) const {
  static const std::string none;
  for (const std::string& each : {in, language}) {
    const auto found = texts.find(each);
    if (found == texts.end()) continue;
    if (const auto entry = found->second.find(key); entry != found->second.end()) return entry->second;
  }
  return none;
}

void read_name(TomlReader& r, const char* key, std::string& name) {
  r.string(key, name);
  if (!is_name(name))
    r.fail_at(key, name.empty() ? std::string(key) + " is missing" : std::string(key) + " is no name",
              "1 to 40 letters, digits, _ and -");
}

void read_text_key(TomlReader& r, const char* key, const Design& design, std::string& text) {
  r.string(key, text);
  if (text.empty()) return;
  std::vector<std::string> known;
  for (const auto& [name, unused] : design.texts.at(design.language)) known.push_back(name);
  require_known(r, key, "text", text, known);
}

Result<Design> parse_design(std::string_view text, const std::string& name) {
  const auto parsed = parse_toml(text, name);
  if (!parsed) return tl::unexpected(parsed.error());
  std::optional<Error> error;
  Design design;
  design.name = name;
  TomlReader r(*parsed, name, "", error);
  r.string("title", design.title);
  read_seed(r, design.seed);
  r.string("scene", design.scene);
  design.set.read(r, "set");
  read_languages(r, design);
  read_consent(r, design);
  read_devices(r, design.devices);
  read_stop(r, design.stop);
  read_materials(r, design.materials);
  read_factors(r, design);
  read_list(r, "question", most_questions, design.questions,
            [&](TomlReader& t, Question& question) { read_question(t, design, question); });
  read_list(r, "step", most_steps, design.steps, [&](TomlReader& t, StepDesign& step) {
    read_step(t, design, step);
    if (step.name.empty()) step.name = fmt::format("{}_{}", name_of(step.kind), design.steps.size() + 1);
  });
  r.table("exclude", [&](TomlReader& t) { read_exclude(t, design.exclude); });
  read_list(r, "family", std::size_t{64}, design.families,
            [](TomlReader& t, Family& family) { read_family(t, family); });
  read_list(r, "hypothesis", std::size_t{128}, design.hypotheses,
            [&](TomlReader& t, Hypothesis& hypothesis) { read_hypothesis(t, design, hypothesis); });
  r.table("analysis", [&](TomlReader& t) { read_analysis(t, design, design.analysis); });
  check_whole(r, design);
  r.finish();
  if (error) return tl::unexpected(*error);
  design.files = {{name, sha256(text)}};
  design.hash = sha256(text);
  return design;
}

Result<void> parse_texts(std::string_view text, const std::string& name, const std::string& language,
                         Design& design) {
  const auto parsed = parse_toml(text, name);
  if (!parsed) return tl::unexpected(parsed.error());
  const toml::table root{{"texts", *parsed}};
  std::optional<Error> error;
  std::map<std::string, std::string> texts;
  TomlReader r(root, name, "", error);
  read_texts(r, "texts", texts);
  if (error) return tl::unexpected(Error{name, error->what, error->fix});
  const auto& own = design.texts.at(design.language);
  const auto names = [](const std::map<std::string, std::string>& all) {
    std::vector<std::string> keys;
    for (const auto& [key, unused] : all) keys.push_back(key);
    return keys;
  };
  for (const auto& [key, unused] : texts) {
    if (own.count(key) > 0) continue;
    const std::string near = nearest_name(key, names(own));
    return fail(fmt::format("{}:{}", name, parsed->get(key)->source().begin.line),
                fmt::format("the design has no text \"{}\"", key),
                near.empty() ? "leave it out" : fmt::format("did you mean \"{}\"?", near));
  }
  for (const auto& [key, unused] : own)
    if (texts.count(key) == 0)
      return fail(name, fmt::format("text \"{}\" is missing", key), "every language needs every text");
  design.texts[language] = std::move(texts);
  return {};
}

}  // namespace intaglio::study
