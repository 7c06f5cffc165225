// The [[step]] tables of a design.
#include <algorithm>

#include "study/design/design_reader.h"

namespace intaglio::study {

namespace {

const std::vector<const char*> block_keys = {
    "factors", "levels",   "materials", "trials", "repeats",  "order",       "material_order", "free",
    "show",    "adaptive", "max_run",   "apart",  "ask_item", "break_after", "break_seconds",  "break_text"};

void read_names(TomlReader& r, const char* key, std::size_t most, std::vector<std::string>& names) {
  r.strings(key, most, names);
}

void read_criterion(TomlReader& r, Criterion& criterion) {
  r.table("criterion", [&](TomlReader& t) {
    t.number("seconds", criterion.seconds, {0, 3600, false, "between 0 s and 3600 s"});
    t.integer("contacts", criterion.contacts, {0, 1e5, false, "between 0 and 100000 contacts"});
    t.integer("correct", criterion.correct, {0, 100, false, "between 0 and 100 right answers"});
    criterion.of = std::max(criterion.correct, 1);
    t.integer("of", criterion.of, {1, 100, false, "between 1 and 100 trials"});
    criterion.at_most = std::max(criterion.of, 20);
    t.integer("at_most", criterion.at_most, {1, double(most_trials), false, "between 1 and 512 trials"});
    t.boolean("ends_session", criterion.ends_session);
    if (criterion.correct > criterion.of || criterion.of > criterion.at_most)
      t.fail_at("correct", "this criterion cannot be met", "correct <= of <= at_most");
  });
}

void read_questions(TomlReader& r, const char* key, const Design& design, std::vector<std::string>& names) {
  read_names(r, key, most_questions, names);
  for (const std::string& name : names) require_known(r, key, "question", name, design.questions);
}

void read_trials(TomlReader& r, const Design& design, StepDesign& step) {
  read_names(r, "factors", most_factors, step.factors);
  for (std::size_t k = 0; k < step.factors.size(); ++k) {
    require_known(r, "factors", "factor", step.factors[k], design.factors);
    if (std::count(step.factors.begin(), step.factors.end(), step.factors[k]) > 1)
      r.fail_at("factors", "a factor is named twice", "once each");
  }
  read_names(r, "materials", most_materials, step.materials);
  for (const std::string& name : step.materials)
    require_known(r, "materials", "material", name, design.materials);
  read_names(r, "levels", most_trials, step.levels);
  if (r.has_failed()) return;
  if (!step.levels.empty() && (step.factors.size() != 1 || r.has("repeats")))
    return r.fail_at("levels", "levels list the trials one by one",
                     "with one factor, and without repeats; several factors are crossed by themselves");
  for (const std::string& level : step.levels)
    require_known(r, "levels", "level", level, design.find_factor(step.factors[0])->levels);
  r.integer("trials", step.trials, {1, double(most_trials), false, "between 1 and 512 trials"});
  r.integer("repeats", step.repeats, {1, double(most_trials), false, "between 1 and 512 repeats"});
  r.choice("order", {"fixed", "latin", "williams", "shuffle"}, step.order);
  r.choice("material_order", {"fixed", "latin", "williams", "shuffle"}, step.material_order);
  r.integer("max_run", step.constraints.max_run, {1, double(most_trials), false, "at least 1 in a row"});
  r.integer("apart", step.constraints.apart, {1, double(most_trials), false, "at least 1 trial apart"});
  if (step.order != Order::shuffle) r.only_keys("an order that is no shuffle", {}, {"max_run", "apart"});
  r.boolean("free", step.is_free);
  r.table("show", [&](TomlReader& t) {
    step.show.read(t, "set");
    if (!step.show.has_placeholder())
      t.fail_at("set", "show sets nothing to the texture",
                "for example show.set.cues.picture.texture = \"@\"");
  });
  if (r.has("adaptive"))
    r.table("adaptive", [&](TomlReader& t) { read_adaptive(t, design, step.adaptive.emplace()); });
  r.optional_key("adaptive");
  if (step.is_free && step.adaptive)
    r.fail_at("free", "an adaptive procedure needs trials one by one", "leave out free or adaptive");
  read_questions(r, "ask_item", design, step.ask_item);
  if (!step.is_free && !step.ask_item.empty())
    r.fail_at("ask_item", "ask_item belongs to free = true", "use ask");
  r.integer("break_after", step.break_after, {1, double(most_trials), false, "at least 1 trial"});
  r.number("break_seconds", step.break_seconds, {0, 3600, false, "between 0 s and 3600 s"});
  read_text_key(r, "break_text", design, step.break_text);
}

std::size_t condition_count(const Design& design, const StepDesign& step) {
  if (!step.levels.empty()) return step.levels.size();
  std::size_t count = std::size_t(step.repeats);
  for (const std::string& name : step.factors) {
    const Factor& factor = *design.find_factor(name);
    if (factor.assign == Factor::Assign::cross) count *= factor.levels.size();
    if (count > most_trials) break;
  }
  return count;
}

void check_trials(TomlReader& r, const Design& design, StepDesign& step) {
  if (r.has_failed()) return;
  const std::size_t conditions = condition_count(design, step);
  const std::size_t materials = step.materials.empty() ? design.materials.size() : step.materials.size();
  const bool is_split = std::any_of(step.factors.begin(), step.factors.end(), [&](const std::string& name) {
    return design.find_factor(name)->assign == Factor::Assign::split;
  });
  if (is_split && materials == 0)
    return r.fail_at("factors", "a split factor splits materials, and there are none", "give [[material]]");
  if (step.trials == 0 && conditions <= most_trials)
    step.trials = int(step.factors.empty() || is_split
                          ? std::max(conditions * std::max<std::size_t>(materials, 1), std::size_t{1})
                          : conditions);
  if (step.trials < 1 || step.trials > int(most_trials))
    return r.fail_at("factors", "the block would have too many trials", "at most 512");
  if (!step.show.empty() && materials < 2)
    return r.fail_at("show", "there are no materials to cycle through", "give [[material]]");
  if (step.is_free && step.trials > int(most_materials))
    return r.fail_at("free", "there are too many items to switch between", "at most 64");
  if (step.order == Order::latin || step.order == Order::williams) {
    if (std::size_t(step.trials) % conditions != 0 && conditions % std::size_t(step.trials) != 0)
      return r.fail_at("order", "the trials do not fit the square",
                       fmt::format("a multiple of {} trials", conditions));
  }
}

}  // namespace

void read_adaptive(TomlReader& r, const Design& design, Adaptive& a) {
  r.choice("method", {"staircase", "quest"}, a.method);
  a.set.read(r, "set");
  if (!a.set.has_placeholder())
    r.fail_at("set", "the procedure sets nothing to its amount",
              "for example set.cues.pen_sound.delay = \"@\"");
  r.string("question", a.question);
  require_known(r, "question", "question", a.question, design.questions);
  if (const Question* question = design.find_question(a.question);
      question != nullptr && question->kind != Question::Kind::yes_no)
    r.fail_at("question", "an adaptive procedure needs a question of yes or no", "kind = \"yes_no\"");
  const Range amount{-1e4, 1e4, false, "an amount must be between -10000 and 10000, in the key's unit"};
  const Range size{0, 1e4, true, "a step must be above 0, in the key's unit"};
  const Range share{0, 0.5, false, "a probability must be between 0 and 0.5"};
  r.number("low", a.low, amount);
  r.number("high", a.high, amount);
  if (a.high <= a.low) r.fail_at("high", "high is not above low", "the range of the amount");
  a.start = 0.5 * (a.low + a.high);
  a.step = 0.25 * (a.high - a.low);
  a.smallest_step = a.step / 16;
  r.number("start", a.start, amount);
  r.number("step", a.step, size);
  r.number("smallest_step", a.smallest_step, size);
  if (a.start < a.low || a.start > a.high) r.fail_at("start", "start is out of low to high", "within them");
  if (a.smallest_step > a.step) r.fail_at("smallest_step", "it is larger than step", "at most step");
  r.integer("down", a.down, {1, 8, false, "between 1 and 8"});
  r.integer("up", a.up, {1, 8, false, "between 1 and 8"});
  r.integer("reversals", a.reversals, {2, 100, false, "between 2 and 100 reversals"});
  r.integer("grid", a.grid, {3, 201, false, "between 3 and 201 amounts"});
  r.number("guess", a.guess, share);
  r.number("lapse", a.lapse, share);
  r.number("slope_low", a.slope_low, {0.1, 50, false, "a slope must be between 0.1 and 50"});
  r.number("slope_high", a.slope_high, {0.1, 50, false, "a slope must be between 0.1 and 50"});
  if (a.slope_high < a.slope_low) r.fail_at("slope_high", "it is below slope_low", "at least slope_low");
  r.number("precision", a.precision, {0, 1, false, "a share of the threshold, 0 to 1"});
  r.number("catch", a.catch_share, share);
  if (a.method == Adaptive::Method::quest) {
    r.only_keys("QUEST+", {"low", "high", "grid", "guess", "lapse", "slope_low", "slope_high", "precision"},
                {"start", "step", "smallest_step", "down", "up", "reversals"});
    if (a.low < 0) r.fail_at("low", "a Weibull function begins at 0", "low >= 0");
  } else {
    r.only_keys("a staircase", {"low", "high", "start", "step", "smallest_step", "down", "up", "reversals"},
                {"grid", "slope_low", "slope_high", "precision"});
  }
}

void read_step(TomlReader& r, const Design& design, StepDesign& step) {
  r.choice("kind", {"consent", "instructions", "preview", "practice", "block", "break", "questionnaire"},
           step.kind);
  if (r.has("name")) read_name(r, "name", step.name);
  r.optional_key("name");
  step.line = r.line_of("kind");
  read_text_key(r, "text", design, step.text);
  r.strings("pictures", 32, step.pictures);
  r.string("scene", step.scene);
  step.set.read(r, "set");
  r.number("seconds", step.seconds, {0, 7200, false, "between 0 s and 7200 s"});
  r.number("time_limit", step.time_limit, {1, 7200, false, "between 1 s and 7200 s"});
  if (r.has("at_limit")) {
    int choice = 0;
    r.choice("at_limit", {"ask", "miss"}, choice);
    step.ends_with_answer = choice == 0;
  }
  r.optional_key("at_limit");
  read_questions(r, "ask", design, step.ask);
  const bool has_trials = step.kind == StepKind::block || step.kind == StepKind::practice;
  if (r.has("criterion") && step.kind != StepKind::practice)
    r.fail_at("criterion", "only a practice has a criterion", "kind = \"practice\"");
  read_criterion(r, step.criterion);
  if (has_trials) {
    read_trials(r, design, step);
    if (step.criterion.correct > 0 && !r.has("trials")) step.trials = step.criterion.at_most;
    if (step.kind == StepKind::block || step.criterion.correct > 0) check_trials(r, design, step);
    if (step.adaptive && std::count(step.ask.begin(), step.ask.end(), step.adaptive->question) == 0)
      r.fail_at("adaptive", "the block does not ask the procedure's question",
                fmt::format("ask = [\"{}\"]", step.adaptive->question));
    return;
  }
  for (const char* key : block_keys) r.optional_key(key);
  r.only_keys(std::string("a step of kind ") + name_of(step.kind), {}, block_keys);
  const bool has_scene = step.kind == StepKind::preview;
  if (!has_scene) r.only_keys(std::string("a step of kind ") + name_of(step.kind), {}, {"scene", "set"});
  if (step.kind == StepKind::questionnaire && step.ask.empty())
    r.fail_at("ask", "the questionnaire asks nothing", "ask = [\"ease\"], names of [[question]]");
  if (step.kind != StepKind::questionnaire)
    r.only_keys(std::string("a step of kind ") + name_of(step.kind), {}, {"ask"});
}

}  // namespace intaglio::study
