#include "study/design/balance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "study/design/order.h"
#include "study/design/plan.h"

namespace intaglio::study {

namespace {

// How often each combination of two variables occurred.
class PairCount {
 public:
  void add(const std::string& row, const std::string& column) {
    ++counts_[{row, column}];
    ++rows_[row];
    ++columns_[column];
    ++total_;
  }

  // Whether it says anything: several rows and columns.
  bool is_table() const { return rows_.size() > 1 && columns_.size() > 1; }

  // Every condition after every other equally often; none follows itself where each is met once.
  void put_succession(PairBalance& pair) const {
    pair.least = total_, pair.most = 0;
    for (const auto& [row, of_row] : rows_)
      for (const auto& [column, of_column] : columns_) {
        if (row == column) continue;
        const auto found = counts_.find({row, column});
        pair.least = std::min(pair.least, found == counts_.end() ? 0 : found->second);
        pair.most = std::max(pair.most, found == counts_.end() ? 0 : found->second);
      }
    pair.largest_deviation = 0.5 * (pair.most - pair.least);
    pair.is_exact = pair.least == pair.most;
  }

  void put(PairBalance& pair) const {
    pair.least = total_, pair.most = 0, pair.largest_deviation = 0;
    for (const auto& [row, of_row] : rows_)
      for (const auto& [column, of_column] : columns_) {
        const auto found = counts_.find({row, column});
        const int count = found == counts_.end() ? 0 : found->second;
        pair.least = std::min(pair.least, count);
        pair.most = std::max(pair.most, count);
        const double implied = double(of_row) * of_column / total_;
        pair.largest_deviation = std::max(pair.largest_deviation, std::abs(count - implied));
      }
    pair.is_exact = pair.largest_deviation < 1e-9;
  }

 private:
  std::map<std::pair<std::string, std::string>, int> counts_;
  std::map<std::string, int> rows_, columns_;
  int total_ = 0;
};

using PairName = std::tuple<std::string, std::string, std::string>;  // block, rows, columns

class BalanceCounter {
 public:
  explicit BalanceCounter(const Design& design) : design_(design) {}

  void add(const Plan& plan) {
    const PlannedStep* previous = nullptr;
    for (const PlannedStep& step : plan.steps) {
      if (step.trial == 0) continue;
      const bool is_free = design_.steps[step.step].is_free;
      if (previous != nullptr && previous->name == step.name &&
          design_.steps[step.step].order != Order::fixed)
        counts_[{step.name, "condition", "the one before"}].add(std::to_string(step.listed),
                                                                std::to_string(previous->listed));
      previous = &step;
      for (const PlannedItem& item : step.items) {
        const std::string place = std::to_string(step.place);
        for (const std::string& level : item.levels) {
          const auto equals = level.find('=');
          const std::string factor = level.substr(0, equals), name = level.substr(equals + 1);
          if (!item.material.empty()) counts_[{step.name, "material", factor}].add(item.material, name);
          if (!is_free) counts_[{step.name, factor, "place"}].add(name, place);
        }
        if (!item.material.empty() && !is_free)
          counts_[{step.name, "material", "place"}].add(item.material, place);
      }
    }
  }

  std::map<PairName, PairBalance> pairs() const {
    std::map<PairName, PairBalance> result;
    for (const auto& [name, count] : counts_) {
      if (!count.is_table()) continue;
      PairBalance& pair = result[name];
      std::tie(pair.block, pair.rows, pair.columns) = name;
      if (pair.columns == "the one before") {
        count.put_succession(pair);
      } else {
        count.put(pair);
      }
    }
    return result;
  }

 private:
  const Design& design_;
  std::map<PairName, PairCount> counts_;
};

}  // namespace

int period_of(const Design& design) {
  constexpr int most = most_participants;
  const auto joined = [](int a, int b) { return int(std::min<long>(std::lcm(long(a), long(b)), most)); };
  int period = 1;
  for (const StepDesign& step : design.steps) {
    if (step.kind != StepKind::block) continue;
    int conditions = step.levels.empty() ? step.repeats : int(step.levels.size());
    for (const std::string& name : step.factors) {
      const Factor& factor = *design.find_factor(name);
      if (factor.assign == Factor::Assign::split) {
        period = joined(period, int(factor.levels.size()));
      } else if (step.levels.empty()) {
        conditions *= int(factor.levels.size());
      }
    }
    const int materials = int(step.materials.empty() ? design.materials.size() : step.materials.size());
    period = joined(period, period_of(step.order, std::max(conditions, 1)));
    period = joined(period, period_of(step.material_order, std::max(materials, 1)));
  }
  return period;
}

Result<Balance> balance(const Design& design, int participants) {
  Balance result{participants, period_of(design), 0, {}};
  // Whether and when a pair becomes exact is looked for over a few periods.
  constexpr int most_looked = 240;
  const int last = std::max(participants, std::min(4 * result.period, most_looked));
  result.looked_at = last;
  BalanceCounter counter(design);
  std::map<PairName, int> exact_from;
  for (int participant = 1; participant <= last; ++participant) {
    const auto made = plan(design, participant);
    if (!made) return tl::unexpected(made.error());
    counter.add(*made);
    const bool is_whole = participant % result.period == 0;
    if (participant != participants && !is_whole) continue;
    for (const auto& [name, pair] : counter.pairs()) {
      if (is_whole && pair.is_exact) exact_from.try_emplace(name, participant);
      if (participant == participants) result.pairs.push_back(pair);
    }
  }
  for (PairBalance& pair : result.pairs)
    if (const auto found = exact_from.find({pair.block, pair.rows, pair.columns}); found != exact_from.end())
      pair.exact_from = found->second;
  return result;
}

}  // namespace intaglio::study
