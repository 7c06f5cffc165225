// Readers of a design's tables. Internal to study/design.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/text.h"
#include "core/toml.h"
#include "study/design/design.h"

namespace intaglio::study {

// A name of something in a design: 1 to 40 letters, digits, '_' or '-'.
void read_name(TomlReader& r, const char* key, std::string& name);
// The key of a text, which must be one of the design's own language.
void read_text_key(TomlReader& r, const char* key, const Design& design, std::string& text);

void read_question(TomlReader& r, const Design& design, Question& question);
void read_step(TomlReader& r, const Design& design, StepDesign& step);
void read_adaptive(TomlReader& r, const Design& design, Adaptive& adaptive);
void read_exclude(TomlReader& r, Exclude& exclude);
void read_family(TomlReader& r, Family& family);
void read_hypothesis(TomlReader& r, const Design& design, Hypothesis& hypothesis);
void read_analysis(TomlReader& r, const Design& design, AnalysisPlan& analysis);

// Reports that `key` names something that the design has not, unless `known` has it.
template <class List>
void require_known(TomlReader& r, const char* key, const std::string& what, const std::string& name,
                   const List& known) {
  std::vector<std::string> names;
  for (const auto& item : known) {
    if constexpr (requires { item.name; }) {
      names.push_back(item.name);
    } else {
      names.push_back(item);
    }
    if (names.back() == name) return;
  }
  const std::string shown = printable(name.substr(0, 60));
  const std::string near = nearest_name(name.substr(0, 60), names);
  if (names.size() > 12) names.resize(12);
  r.fail_at(key, fmt::format("there is no {} \"{}\"", what, shown),
            !near.empty()   ? fmt::format("did you mean \"{}\"?", near)
            : names.empty() ? fmt::format("the design has no {} at all", what)
                            : fmt::format("one of \"{}\"", fmt::join(names, "\", \"")));
}

}  // namespace intaglio::study
