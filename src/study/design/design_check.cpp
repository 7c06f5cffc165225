// The answer of `study check`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>

#include "study/design/balance.h"
#include "study/design/design_pages.h"
#include "study/design/design_power.h"
#include "study/design/duration.h"
#include "study/design/plan.h"

namespace intaglio::study {

namespace {

std::string minutes(double seconds) {
  return seconds < 60 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", std::ceil(seconds / 60));
}

std::string what_is_met(const PlannedStep& step) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  for (const PlannedItem& item : step.items) {
    std::string met = item.material;
    for (const std::string& level : item.levels) met += (met.empty() ? "" : ", ") + level;
    if (step.kind != StepKind::preview && !met.empty()) add(met);
  }
  if (step.kind == StepKind::preview) add(fmt::format("{} materials are seen", step.items.size()));
  if (!step.shown.empty()) add(fmt::format("{} pictures to choose from", step.shown.size()));
  if (!step.track.empty()) add(step.is_catch ? "catch trial" : "adaptive");
  if (step.trial > 0 && !step.notices.empty())
    add(fmt::format("said before: {}", fmt::join(step.notices, ", ")));
  if (!step.ask_item.empty()) add(fmt::format("of each: {}", fmt::join(step.ask_item, ", ")));
  if (!step.ask.empty()) add(fmt::format("asks {}", fmt::join(step.ask, ", ")));
  if (step.least_seconds > 0) add(fmt::format("at least {:.0f} s", step.least_seconds));
  if (step.time_limit) add(fmt::format("at most {:.0f} s", *step.time_limit));
  return text;
}

std::string criterion_text(const Criterion& criterion) {
  std::string text;
  if (criterion.contacts > 0) text += fmt::format("; at least {} contacts", criterion.contacts);
  if (criterion.correct > 0)
    text +=
        fmt::format("; until {} of {} are right, at most {} trials, then {}", criterion.correct, criterion.of,
                    criterion.at_most, criterion.ends_session ? "the session ends" : "it goes on");
  return text;
}

// The last of the adaptive trials that follow step `k` without a break; `k` itself for other steps.
std::size_t last_alike(const Plan& plan, std::size_t k) {
  std::size_t last = k;
  while (!plan.steps[k].track.empty() && last + 1 < plan.steps.size() &&
         !plan.steps[last + 1].track.empty() && plan.steps[last + 1].step == plan.steps[k].step)
    ++last;
  return last;
}

std::string adaptive_text(const Design& design, const Plan& plan, std::size_t first, std::size_t last) {
  const PlannedStep& step = plan.steps[first];
  const Adaptive& adaptive = *design.steps[step.step].adaptive;
  std::set<std::string> tracks;
  int catches = 0;
  for (std::size_t k = first; k <= last; ++k) {
    tracks.insert(plan.steps[k].track);
    catches += plan.steps[k].is_catch ? 1 : 0;
  }
  std::string text =
      fmt::format("{}, {:g} to {:g}", adaptive.method == Adaptive::Method::quest ? "QUEST+" : "staircase",
                  adaptive.low, adaptive.high);
  if (tracks.size() > 1) text += fmt::format(", {} procedures in turn", tracks.size());
  if (catches > 0) text += fmt::format(", {} catch trials", catches);
  return text + fmt::format("; asks {}", fmt::join(step.ask, ", "));
}

std::string session_text(const Design& design, const Plan& plan) {
  std::string text = fmt::format("Participant {} (order {})\n", plan.participant, plan_hash(plan));
  double at = 0;
  std::size_t next = 0;
  while (next < plan.steps.size()) {
    const std::size_t first = next, last = last_alike(plan, first);
    const PlannedStep& step = plan.steps[first];
    std::string what = step.track.empty() ? what_is_met(step) : adaptive_text(design, plan, first, last);
    if (step.kind == StepKind::practice) what += criterion_text(design.steps[step.step].criterion);
    std::string number = name_of(step.kind);
    if (step.trial > 0)
      number = last == first ? fmt::format("trial {}", step.trial)
                             : fmt::format("trials {}-{}", step.trial, plan.steps[last].trial);
    text += fmt::format("  {:>6}  {:14} {:18} {}", minutes(at), number, step.name, what);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
    for (; next <= last; ++next) at += duration_of(design, plan.steps[next]).expected;
  }
  const Duration all = duration_of(design, plan);
  text += fmt::format("Takes about {}", minutes(all.expected));
  text += all.longest ? fmt::format(", at most {}.", minutes(*all.longest))
                      : std::string("; trials have no limit of time.");
  if (const auto most = design.stop.session_minutes)
    text += fmt::format(" A session is ended after {:g} min.", *most);
  if (design.stop.session_minutes && all.expected > 60 * *design.stop.session_minutes)
    text += " That is before its expected end!";
  return text + "\n";
}

std::string balance_text(const Design& design, const Balance& balance) {
  const int n = balance.participants, period = balance.period;
  std::string text = fmt::format("\nBalance at {} participants\n", n);
  for (const PairBalance& pair : balance.pairs) {
    const std::string name = fmt::format("{}: {} x {}", pair.block, pair.rows, pair.columns);
    if (pair.is_exact) {
      text += fmt::format("  exact      {} ({} each)\n", name,
                          pair.least == pair.most ? std::to_string(pair.least)
                                                  : fmt::format("{} to {}", pair.least, pair.most));
    } else if (pair.exact_from > 0) {
      text += fmt::format("  not exact  {}: counts {} to {}, up to {:.1f} from even; exact at {}, {}, ...\n",
                          name, pair.least, pair.most, pair.largest_deviation, pair.exact_from,
                          2 * pair.exact_from);
    } else {
      const auto step = std::find_if(design.steps.begin(), design.steps.end(),
                                     [&](const StepDesign& each) { return each.name == pair.block; });
      const bool is_fixed = step->order == Order::fixed && pair.columns == "place" && pair.rows != "material";
      text += fmt::format(
          "  never      {}: counts {} to {}: {}\n", name, pair.least, pair.most,
          is_fixed ? std::string("the order is fixed, so that practice is confounded with it")
                   : fmt::format("exact at no multiple of {} up to {}", period, balance.looked_at));
    }
  }
  if (balance.pairs.empty()) text += "  nothing varies over participants\n";
  if (period > 1)
    text += n % period == 0
                ? fmt::format("All squares are whole: {} is a multiple of {}.\n", n, period)
                : fmt::format("{} is no multiple of {}: orders balance exactly at {} or {} participants.\n",
                              n, period, std::max(n / period, 1) * period,
                              (n / period + (n < period ? 1 : 0) + 1) * period);
  return text;
}

std::string power_text(const Design& design, const std::vector<HypothesisPower>& all, int participants) {
  if (all.empty()) return "\nNo hypotheses are stated.\n";
  std::string text =
      fmt::format("\nPower at {} participants (wanted: {:g})\n", participants, design.analysis.power);
  for (const HypothesisPower& each : all) {
    text += each.power
                ? fmt::format("  {:.2f}{}  {} (alpha {:.3g}; {})\n", *each.power,
                              *each.power < design.analysis.power ? " low" : "    ", each.hypothesis,
                              each.alpha, each.why)
                : fmt::format("  ?         {} (alpha {:.3g}; {})\n", each.hypothesis, each.alpha, each.why);
  }
  return text;
}

}  // namespace

Result<std::string> check_text(const Design& design, int participants, int shown_participant) {
  const auto shown = plan(design, shown_participant);
  if (!shown) return tl::unexpected(shown.error());
  const auto balanced = balance(design, participants);
  if (!balanced) return tl::unexpected(balanced.error());
  const auto powers = power_of(design, participants);
  if (!powers) return tl::unexpected(powers.error());
  return fmt::format("{}: {}\nDesign {}, seed {}\n\n", design.name, design.title, design.hash.substr(0, 16),
                     design.seed) +
         session_text(design, *shown) + balance_text(design, *balanced) +
         power_text(design, *powers, participants);
}

}  // namespace intaglio::study
