#include "study/design/duration.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace intaglio::study {

namespace {

double seconds_to_read(const std::string& text) {
  const auto words =
      std::count_if(text.begin(), text.end(), [](char c) { return c == ' ' || c == '\n'; }) + 1;
  return text.empty() ? 0 : 60.0 * double(words) / 200;
}

double seconds_to_answer(const Design& design, const std::vector<std::string>& questions) {
  double seconds = 0;
  for (const std::string& name : questions) {
    const Question& question = *design.find_question(name);
    switch (question.kind) {
      case Question::Kind::text:
        seconds += 45;
        break;
      case Question::Kind::tlx:  // six scales, and with weights fifteen comparisons
        seconds += question.has_weights ? 6 * 8 + 15 * 4 : 6 * 8;
        break;
      case Question::Kind::yes_no:
        seconds += 3;
        break;
      default:
        seconds += 8;
    }
  }
  return seconds;
}

}  // namespace

Duration duration_of(const Design& design, const PlannedStep& planned) {
  if (planned.kind == StepKind::end) return {0, 0};
  const StepDesign& step = design.steps.at(planned.step);
  constexpr double between = 3;
  double pages = between;
  for (const std::string& key : planned.notices) pages += seconds_to_read(design.text(key, design.language));
  if (planned.kind == StepKind::consent && design.consent)
    pages += seconds_to_read(design.text(design.consent->text, design.language)) + 15;
  pages += seconds_to_answer(design, planned.ask);
  pages += double(planned.items.size()) * seconds_to_answer(design, planned.ask_item);
  const bool is_active =
      planned.is_trial || planned.kind == StepKind::practice || planned.kind == StepKind::preview;
  double active = planned.least_seconds;
  if (is_active) active = std::max(active, step.seconds > 0 ? step.seconds : 40);
  if (!is_active && planned.kind != StepKind::pause) active = std::max(active, step.seconds - pages);
  if (planned.time_limit) active = std::min(active, *planned.time_limit);
  Duration duration{pages + active, std::nullopt};
  if (!is_active) {
    duration.longest = duration.expected;
  } else if (planned.time_limit) {
    duration.longest = pages + *planned.time_limit;
  }
  return duration;
}

Duration duration_of(const Design& design, const Plan& plan) {
  Duration all{0, 0};
  for (const PlannedStep& step : plan.steps) {
    const Duration each = duration_of(design, step);
    all.expected += each.expected;
    if (all.longest && each.longest) {
      *all.longest += *each.longest;
    } else {
      all.longest.reset();
    }
  }
  return all;
}

}  // namespace intaglio::study
