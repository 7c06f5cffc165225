#include "study/design/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/hash.h"
#include "core/text.h"
#include "scene/scene_table.h"
#include "study/design/order.h"

namespace intaglio::study {

namespace {

// A crossing of levels: the number of the level of each of the step's factors (-1: split).
struct Cell {
  std::vector<int> levels;
};

struct Slot {
  int cell = 0, material = -1;  // numbers among the cells, and the design's materials
};

int number_of(const std::vector<StudyMaterial>& materials, const std::string& name) {
  for (std::size_t k = 0; k < materials.size(); ++k)
    if (materials[k].name == name) return int(k);
  return -1;
}

class Planner {
 public:
  Planner(const Design& design, int participant) : design_(design), participant_(participant) {}

  Result<Plan> make() {
    plan_.participant = participant_;
    for (std::size_t k = 0; k < design_.steps.size(); ++k)
      if (auto added = add_step(k); !added) return tl::unexpected(added.error());
    PlannedStep& end = plan_.steps.emplace_back();
    end.kind = StepKind::end;
    end.step = design_.steps.size();
    end.name = "end";
    return std::move(plan_);
  }

 private:
  std::string purpose(const StepDesign& step, const char* what, int round = 0) const {
    return fmt::format("{}/{}/{}", step.name, what, round);
  }

  Result<void> add_step(std::size_t number) {
    const StepDesign& step = design_.steps[number];
    const bool has_trials =
        step.kind == StepKind::block || (step.kind == StepKind::practice && step.trials > 0);
    if (has_trials) return add_trials(number);
    PlannedStep planned = page(number);
    planned.ask = step.ask;
    planned.time_limit = step.time_limit;
    planned.least_seconds = step.kind == StepKind::pause ? step.seconds : step.criterion.seconds;
    if (step.kind == StepKind::practice) planned.items.push_back({"", {}, step.set});
    if (step.kind == StepKind::preview)
      for (const StudyMaterial& material : design_.materials)
        planned.items.push_back(preview_of(step, material));
    plan_.steps.push_back(std::move(planned));
    return {};
  }

  PlannedStep page(std::size_t number) const {
    PlannedStep planned;
    planned.kind = design_.steps[number].kind;
    planned.step = number;
    planned.name = design_.steps[number].name;
    if (!design_.steps[number].text.empty()) planned.notices = {design_.steps[number].text};
    return planned;
  }

  PlannedItem preview_of(const StepDesign& step, const StudyMaterial& material) const {
    PlannedItem item{material.name, {}, step.set};
    Overrides all = material.set;
    all.put_all(step.set);
    item.set = std::move(all);
    return item;
  }

  std::vector<Cell> cells_of(const StepDesign& step) const {
    std::vector<Cell> cells;
    if (!step.levels.empty()) {
      const Factor& factor = *design_.find_factor(step.factors[0]);
      for (const std::string& name : step.levels)
        for (std::size_t k = 0; k < factor.levels.size(); ++k)
          if (factor.levels[k].name == name) cells.push_back({{int(k)}});
      return cells;
    }
    cells.push_back({});
    for (const std::string& name : step.factors) {
      const Factor& factor = *design_.find_factor(name);
      const int count = factor.assign == Factor::Assign::split ? 1 : int(factor.levels.size());
      std::vector<Cell> crossed;
      for (const Cell& cell : cells)
        for (int k = 0; k < count; ++k) {
          crossed.push_back(cell);
          crossed.back().levels.push_back(factor.assign == Factor::Assign::split ? -1 : k);
        }
      cells = std::move(crossed);
    }
    const auto once = cells;
    for (int repeat = 1; repeat < step.repeats; ++repeat) cells.insert(cells.end(), once.begin(), once.end());
    return cells;
  }

  std::vector<int> materials_of(const StepDesign& step) const {
    std::vector<int> numbers;
    for (const std::string& name : step.materials) numbers.push_back(number_of(design_.materials, name));
    if (step.materials.empty())
      for (std::size_t k = 0; k < design_.materials.size(); ++k) numbers.push_back(int(k));
    return numbers;
  }

  // The trials as listed, each with its material.
  std::vector<Slot> slots_of(const StepDesign& step, int cell_count) const {
    const auto materials = materials_of(step);
    const int m = int(materials.size());
    const bool is_crossed = m > 0 && step.trials % (m * cell_count) == 0;
    std::vector<Slot> slots;
    std::vector<int> order;
    for (int k = 0; k < step.trials; ++k) {
      Slot slot{is_crossed ? (k / m) % cell_count : k % cell_count, -1};
      if (m > 0) {
        if (k % m == 0)
          order =
              order_of(step.material_order, m, participant_, design_.seed, purpose(step, "materials", k / m));
        slot.material = materials[std::size_t(order[std::size_t(k % m)])];
      }
      slots.push_back(slot);
    }
    return slots;
  }

  // Slots in the order of a square over conditions: round by round, each the next slot of its condition.
  std::vector<int> square_order(const StepDesign& step, const std::vector<Slot>& slots,
                                int cell_count) const {
    std::vector<std::vector<int>> waiting;
    waiting.resize(std::size_t(cell_count));
    for (std::size_t k = 0; k < slots.size(); ++k) waiting[std::size_t(slots[k].cell)].push_back(int(k));
    std::vector<int> result;
    for (std::size_t round = 0; result.size() < slots.size(); ++round) {
      const auto row =
          order_of(step.order, cell_count, participant_, design_.seed, purpose(step, "order", int(round)));
      for (const int cell : row)
        if (round < waiting[std::size_t(cell)].size()) result.push_back(waiting[std::size_t(cell)][round]);
    }
    return result;
  }

  Result<std::vector<int>> order_slots(const StepDesign& step, const std::vector<Slot>& slots,
                                       const std::vector<Cell>& cells) const {
    if (step.order == Order::latin || step.order == Order::williams)
      return square_order(step, slots, int(cells.size()));
    Random random = random_stream(design_.seed, purpose(step, "order"), participant_);
    if (step.order == Order::fixed) return order_of(Order::fixed, int(slots.size()), 1, 0, "");
    std::vector<int> conditions, materials;
    for (const Slot& slot : slots) {
      // Equal crossings are one condition, whatever their number.
      const auto same = std::find_if(cells.begin(), cells.end(), [&](const Cell& cell) {
        return cell.levels == cells[std::size_t(slot.cell)].levels;
      });
      conditions.push_back(int(same - cells.begin()));
      materials.push_back(slot.material);
    }
    return constrained_shuffle(conditions, materials, step.constraints, random);
  }

  PlannedItem item_of(const StepDesign& step, const Cell& cell, int material,
                      std::vector<std::string>& notices) const {
    PlannedItem item;
    if (material >= 0) {
      item.material = design_.materials[std::size_t(material)].name;
      item.set = design_.materials[std::size_t(material)].set;
    }
    item.set.put_all(step.set);
    for (std::size_t k = 0; k < step.factors.size(); ++k) {
      const Factor& factor = *design_.find_factor(step.factors[k]);
      const int number =
          cell.levels[k] >= 0 ? cell.levels[k] : split_level(design_, factor, participant_, material);
      const Level& level = factor.levels[std::size_t(number)];
      item.levels.push_back(factor.name + "=" + level.name);
      item.set.put_all(level.set);
      if (!level.say.empty() && std::find(notices.begin(), notices.end(), level.say) == notices.end())
        notices.push_back(level.say);
    }
    if (step.adaptive) item.set.put_all(step.adaptive->set);
    return item;
  }

  // Which places of an adaptive block are catch trials; never the first.
  std::vector<bool> catch_places(const StepDesign& step) const {
    std::vector<bool> places(std::size_t(step.trials), false);
    if (!step.adaptive || step.trials < 2) return places;
    Random random = random_stream(design_.seed, purpose(step, "catch"), participant_);
    const auto order = shuffled(step.trials - 1, random);
    const int count = int(step.adaptive->catch_share * step.trials);
    for (int k = 0; k < count && k < int(order.size()); ++k)
      places[std::size_t(order[std::size_t(k)] + 1)] = true;
    return places;
  }

  std::vector<std::string> shown_in(const StepDesign& step, int place) const {
    if (step.show.empty()) return {};
    // The stream is one of its own, so that neither order nor start says anything of the material.
    Random random = random_stream(design_.seed, purpose(step, "shown", place), participant_);
    const auto materials = materials_of(step);
    std::vector<std::string> names;
    for (const int k : shuffled(int(materials.size()), random))
      names.push_back(design_.materials[std::size_t(materials[std::size_t(k)])].name);
    return names;
  }

  Result<void> add_trials(std::size_t number) {
    const StepDesign& step = design_.steps[number];
    const auto cells = cells_of(step);
    const auto slots = slots_of(step, int(cells.size()));
    const auto order = order_slots(step, slots, cells);
    if (!order) return tl::unexpected(with_where(step.line, order.error()));
    if (step.is_free) return add_free(number, cells, slots, *order);
    const auto catches = catch_places(step);
    for (int place = 1; place <= step.trials; ++place) {
      const Slot& slot = slots[std::size_t((*order)[std::size_t(place - 1)])];
      PlannedStep planned = trial(number, place);
      planned.items.push_back(item_of(step, cells[std::size_t(slot.cell)], slot.material, planned.notices));
      planned.listed = slot.cell + 1;
      planned.shown = shown_in(step, place);
      if (!planned.shown.empty()) planned.answer = planned.items[0].material;
      if (step.adaptive) planned.track = track_of(step, planned.items[0]);
      planned.is_catch = catches[std::size_t(place - 1)];
      plan_.steps.push_back(std::move(planned));
      if (step.break_after > 0 && place % step.break_after == 0 && place < step.trials) add_break(number);
    }
    return {};
  }

  std::string track_of(const StepDesign& step, const PlannedItem& item) const {
    std::string track = step.name;
    for (const std::string& level : item.levels) track += "/" + level;
    return track;
  }

  PlannedStep trial(std::size_t number, int place) {
    const StepDesign& step = design_.steps[number];
    PlannedStep planned = page(number);
    planned.is_trial = true;
    planned.place = place;
    if (step.kind == StepKind::block) planned.trial = ++trials_;
    if (place > 1) planned.notices.clear();
    planned.ask = step.ask;
    planned.ask_item = step.ask_item;
    planned.time_limit = step.time_limit;
    return planned;
  }

  Result<void> add_free(std::size_t number, const std::vector<Cell>& cells, const std::vector<Slot>& slots,
                        const std::vector<int>& order) {
    const StepDesign& step = design_.steps[number];
    PlannedStep planned = trial(number, 1);
    for (const int k : order) {
      const Slot& slot = slots[std::size_t(k)];
      planned.items.push_back(item_of(step, cells[std::size_t(slot.cell)], slot.material, planned.notices));
    }
    plan_.steps.push_back(std::move(planned));
    return {};
  }

  void add_break(std::size_t number) {
    const StepDesign& step = design_.steps[number];
    PlannedStep planned = page(number);
    planned.kind = StepKind::pause;
    planned.notices.clear();
    if (!step.break_text.empty()) planned.notices = {step.break_text};
    planned.least_seconds = step.break_seconds;
    plan_.steps.push_back(std::move(planned));
  }

  const Design& design_;
  int participant_;
  Plan plan_;
  int trials_ = 0;
};

}  // namespace

int split_level(const Design& design, const Factor& factor, int participant, int material) {
  const int levels = int(factor.levels.size());
  // The group's shuffle deals the materials; each of the group is dealt the next level.
  Random random = random_stream(design.seed, "split/" + factor.name, (participant - 1) / levels);
  const auto order = shuffled(int(design.materials.size()), random);
  const auto at = std::find(order.begin(), order.end(), material);
  return (int(at - order.begin()) + participant - 1) % levels;
}

Result<Plan> plan(const Design& design, int participant) {
  if (participant < 1 || participant > most_participants)
    return fail(design.name, fmt::format("there is no participant {}", participant),
                fmt::format("numbers go from 1 to {}", most_participants));
  return Planner(design, participant).make();
}

std::string plan_text(const Plan& plan) {
  const auto list = [](const std::vector<std::string>& items) {
    return fmt::format("{}", fmt::join(items, ","));
  };
  std::string text = fmt::format("participant {}\n", plan.participant);
  for (const PlannedStep& step : plan.steps) {
    text += fmt::format(
        "{} {} trial={} place={} notices={} ask={} ask_item={} shown={} answer={} track={} catch={}",
        name_of(step.kind), step.name, step.trial, step.place, list(step.notices), list(step.ask),
        list(step.ask_item), list(step.shown), step.answer, step.track, int(step.is_catch));
    text += fmt::format(" limit={} least={}\n", step.time_limit.value_or(0), step.least_seconds);
    for (const PlannedItem& item : step.items) {
      text += fmt::format("  {} {}", item.material, list(item.levels));
      for (const auto& [key, value] : item.set.values()) text += fmt::format("; {} = {}", key, value);
      text += "\n";
    }
  }
  return text;
}

std::string plan_hash(const Plan& plan) {
  Hash hash;
  hash.add(plan_text(plan));
  return fmt::format("{:016x}", hash.value());
}

Result<scene::Scene> scene_of(const Design& design, const PlannedStep& planned, std::size_t item,
                              std::optional<double> amount, const std::string& shown) {
  const StepDesign& step = design.steps.at(planned.step);
  Overrides all = design.set;
  Overrides own = planned.items.at(item).set;
  if (amount) own = own.with(toml_number(*amount));
  all.put_all(own);
  if (const StudyMaterial* const material = design.find_material(shown); material != nullptr)
    all.put_all(step.show.with(material->set.values().at("surface.texture")));
  auto scene = scene_with(step.scene.empty() ? design.scene_text : step.scene_text, all,
                          step.line.empty() ? design.name : step.line);
  if (scene) scene::find_files_beside(*scene, std::filesystem::path(design.name).parent_path());
  return scene;
}

}  // namespace intaglio::study
