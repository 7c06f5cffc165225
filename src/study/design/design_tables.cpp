// Questions, exclusions and hypotheses of a design.
#include "study/design/design_reader.h"

namespace intaglio::study {

void read_question(TomlReader& r, const Design& design, Question& question) {
  using Kind = Question::Kind;
  read_name(r, "name", question.name);
  r.choice("kind", {"choice", "yes_no", "rating", "frequency", "tlx", "text"}, question.kind);
  read_text_key(r, "text", design, question.text);
  r.integer("low", question.low, {-100, 100, false, "a rating's end must be between -100 and 100"});
  r.integer("high", question.high, {-100, 100, false, "a rating's end must be between -100 and 100"});
  read_text_key(r, "low_says", design, question.low_says);
  read_text_key(r, "high_says", design, question.high_says);
  r.strings("choices", 32, question.choices);
  for (const std::string& choice : question.choices) {
    std::vector<std::string> known;
    for (const auto& [name, unused] : design.texts.at(design.language)) known.push_back(name);
    require_known(r, "choices", "text", choice, known);
  }
  r.boolean("required", question.is_required);
  r.boolean("weights", question.has_weights);
  if (r.has_failed()) return;
  const std::vector<const char*> all = {"low", "high", "low_says", "high_says", "choices", "weights"};
  switch (question.kind) {
    case Kind::rating:
      r.only_keys("a rating", {"low", "high", "low_says", "high_says"}, all);
      break;
    case Kind::choice:
    case Kind::frequency:
      r.only_keys("a choice", {"choices"}, all);
      break;
    case Kind::tlx:
      r.only_keys("a NASA-TLX", {"weights"}, all);
      break;
    default:
      r.only_keys("this kind of question", {}, all);
  }
  if (question.high <= question.low)
    r.fail_at("high", "a rating's high is not above its low", "for example low = 1, high = 10");
  if ((question.kind == Kind::choice || question.kind == Kind::frequency) && question.choices.size() < 2)
    r.fail_at("choices", "question " + question.name + " has no choices",
              "at least two keys of texts; a frequency's go from always to never");
  if (question.text.empty() && question.kind != Kind::tlx)
    r.fail_at("text", "question " + question.name + " asks nothing", "text = \"KEY\", a key of [texts]");
}

namespace {

void read_count(TomlReader& r, const char* key, std::optional<int>& value) {
  if (!r.has(key)) return r.optional_key(key);
  r.integer(key, value.emplace(0), {0, 1e6, false, "a count must be between 0 and 1e6"});
}

}  // namespace

void read_exclude(TomlReader& r, Exclude& exclude) {
  const Range share{0, 1, false, "a share must be between 0 and 1"};
  const Range time{0, 3600, false, "a time must be between 0 s and 3600 s"};
  r.number("faster_than", exclude.faster_than, time);
  r.number("slower_than", exclude.slower_than, time);
  read_count(r, "dropped_audio", exclude.dropped_audio);
  read_count(r, "guard_trips", exclude.guard_trips);
  read_count(r, "reconnects", exclude.reconnects);
  read_count(r, "focus_losses", exclude.focus_losses);
  r.number("late_frames", exclude.late_frames, share);
  r.number("rate_below", exclude.rate_below, share);
  r.number("false_alarms_above", exclude.false_alarms_above, share);
  read_count(r, "missing_above", exclude.missing_above);
  r.boolean("practice_failed", exclude.practice_failed);
}

void read_family(TomlReader& r, Family& family) {
  read_name(r, "name", family.name);
  r.number("alpha", family.alpha, {0.0001, 0.5, false, "alpha must be between 0.0001 and 0.5"});
  r.choice("correction", {"holm", "bonferroni", "none"}, family.correction);
}

void read_hypothesis(TomlReader& r, const Design& design, Hypothesis& hypothesis) {
  using Test = Hypothesis::Test;
  read_name(r, "name", hypothesis.name);
  r.string("family", hypothesis.family);
  r.string("says", hypothesis.says);
  r.string("measure", hypothesis.measure);
  r.string("factor", hypothesis.factor);
  r.strings("compare", 2, hypothesis.compare);
  r.choice("test", {"paired", "independent", "welch", "wilcoxon", "mann_whitney", "mixed", "chance"},
           hypothesis.test);
  r.choice("direction", {"two_sided", "greater", "less"}, hypothesis.direction);
  r.number("margin", hypothesis.margin,
           {0, 1e6, true, "a margin must be greater than 0, in the measure's unit"});
  r.number("effect", hypothesis.effect, {0, 10, true, "an effect, Cohen's d, must be above 0, at most 10"});
  if (r.has_failed()) return;
  if (hypothesis.says.empty() || hypothesis.says.size() > 1000)
    r.fail_at("says", "a hypothesis says nothing, or over 1000 letters", "says = \"Without sound ...\"");
  require_known(r, "family", "[[family]]", hypothesis.family, design.families);
  std::vector<std::string> measures = {"correct", "time", "threshold"};
  for (const Question& question : design.questions) measures.push_back(question.name);
  require_known(r, "measure", "measure", hypothesis.measure, measures);
  if (hypothesis.test == Test::chance && hypothesis.factor.empty() && hypothesis.compare.empty()) return;
  require_known(r, "factor", "factor", hypothesis.factor, design.factors);
  if (r.has_failed()) return;
  for (const std::string& level : hypothesis.compare)
    require_known(r, "compare", "level", level, design.find_factor(hypothesis.factor)->levels);
  if (hypothesis.compare.size() != (hypothesis.test == Test::chance ? 1u : 2u))
    r.fail_at("compare", "the number of levels does not fit the test",
              "two levels of the factor; a test against chance takes one, or neither factor nor levels");
}

void read_analysis(TomlReader& r, const Design& design, AnalysisPlan& analysis) {
  r.number("effect", analysis.effect, {0, 10, true, "an effect, Cohen's d, must be above 0, at most 10"});
  r.table("rates", [&](TomlReader& t) {
    for (const Factor& factor : design.factors)
      for (const Level& level : factor.levels) {
        std::optional<double> rate;
        t.number(level.name.c_str(), rate, {0.001, 0.999, false, "a rate must be between 0.001 and 0.999"});
        if (rate) analysis.rates[level.name] = *rate;
      }
  });
  r.number("person_deviation", analysis.person_deviation,
           {0, 10, false, "a deviation of log odds must be between 0 and 10"});
  r.number("power", analysis.power, {0.05, 0.999, false, "a power must be between 0.05 and 0.999"});
}

}  // namespace intaglio::study
