// A design as a preregistration.
#include <fmt/format.h>

#include "study/design/balance.h"
#include "study/design/design_pages.h"
#include "study/design/design_power.h"

namespace intaglio::study {

namespace {

const char* name_of(Hypothesis::Test test) {
  constexpr const char* names[] = {"paired t-test over persons' means",
                                   "independent t-test (Student)",
                                   "independent t-test (Welch)",
                                   "Wilcoxon's signed-rank test over persons' means",
                                   "Mann-Whitney test",
                                   "linear mixed model, persons and materials as random effects",
                                   "exact binomial test against chance"};
  return names[int(test)];
}

std::string hypotheses_text(const Design& design) {
  std::string text = "## Hypotheses\n\n";
  if (design.hypotheses.empty()) return text + "None: the study is exploratory.\n";
  for (const Family& family : design.families) {
    constexpr const char* corrections[] = {"Holm", "Bonferroni", "no"};
    text += fmt::format("Family *{}*: alpha {:g}, {} correction.\n\n", family.name, family.alpha,
                        corrections[int(family.correction)]);
    for (const Hypothesis& each : design.hypotheses) {
      if (each.family != family.name) continue;
      text += fmt::format("- **{}**: {}. Measure: {}", each.name, each.says, each.measure);
      if (!each.compare.empty())
        text += fmt::format("; {}: {}", each.factor, fmt::join(each.compare, " against "));
      constexpr const char* directions[] = {"two-sided", "the first is greater", "the first is less"};
      text += fmt::format(". Test: {}, {}.", name_of(each.test), directions[int(each.direction)]);
      if (each.margin) text += fmt::format(" Claims equivalence within {:g}.", *each.margin);
      text += "\n";
    }
    text += "\n";
  }
  return text;
}

std::string exclusions_text(const Exclude& exclude) {
  std::string text;
  const auto add = [&](const auto& value, const char* says) {
    if (value) text += fmt::format("- {} {:g}\n", says, double(*value));
  };
  add(exclude.faster_than, "trials answered faster than, s:");
  add(exclude.slower_than, "trials answered slower than, s:");
  add(exclude.dropped_audio, "trials whose dropped blocks of sound exceed");
  add(exclude.guard_trips, "trials whose trips of the force guard exceed");
  add(exclude.reconnects, "trials whose reconnections of the device exceed");
  add(exclude.focus_losses, "trials whose losses of the window's focus exceed");
  add(exclude.late_frames, "trials whose share of late frames exceeds");
  add(exclude.rate_below, "persons whose share of right answers is below");
  add(exclude.false_alarms_above, "persons whose share of false alarms in catch trials exceeds");
  add(exclude.missing_above, "persons whose trials without an answer exceed");
  if (exclude.practice_failed) text += "- persons who did not meet the criterion of a practice\n";
  return text.empty() ? "Nothing is excluded.\n"
                      : text + "\nResults are reported with and without exclusions.\n";
}

std::string sample_text(const Design& design) {
  std::string text = fmt::format("{} participants; their data are not looked at before the last one.\n",
                                 design.stop.participants);
  const int period = period_of(design);
  text += fmt::format("Orders balance exactly at multiples of {}.\n", period);
  if (const auto minutes = design.stop.session_minutes)
    text += fmt::format("A session ends after {:g} minutes with its questionnaire.\n", *minutes);
  if (const auto powers = power_of(design, design.stop.participants)) {
    text += "\n| hypothesis | alpha | power | found by |\n|---|---|---|---|\n";
    for (const HypothesisPower& each : *powers)
      text += fmt::format("| {} | {:.3g} | {} | {} |\n", each.hypothesis, each.alpha,
                          each.power ? fmt::format("{:.2f}", *each.power) : "not known", each.why);
  }
  return text;
}

std::string conditions_text(const Design& design) {
  std::string text;
  for (const Factor& factor : design.factors) {
    text += fmt::format("Factor *{}*{}:\n\n", factor.name,
                        factor.assign == Factor::Assign::split ? ", one level a material and person" : "");
    for (const Level& level : factor.levels) {
      text += fmt::format("- {}", level.name);
      for (const auto& [key, value] : level.set.values()) text += fmt::format("; `{} = {}`", key, value);
      text += "\n";
    }
    text += "\n";
  }
  text += "Materials:";
  for (const StudyMaterial& material : design.materials) text += " " + material.name;
  return text + (design.materials.empty() ? " the scene's own.\n" : ".\n");
}

}  // namespace

std::string preregistration(const Design& design) {
  std::string text = fmt::format("# {}\n\nDesign `{}`, seed {}.\n\n", design.title, design.hash, design.seed);
  text += hypotheses_text(design);
  text += "## Conditions\n\n" + conditions_text(design);
  text += "\n## Sample size and stop rule\n\n" + sample_text(design);
  text += "\n## Exclusions\n\n" + exclusions_text(design.exclude);
  text +=
      "\n## Analysis\n\n`intaglio study analyse`: the tests above; beside each pooled interval a bootstrap "
      "over persons, because trials of one person are not independent. Synthetic data are never pooled "
      "with people's.\n";
  text += "\n## Files\n\n| file | SHA-256 |\n|---|---|\n";
  for (const DesignFile& file : design.files)
    text += fmt::format("| {} | `{}` |\n", std::filesystem::path(file.name).filename().string(), file.sha256);
  return text;
}

}  // namespace intaglio::study
