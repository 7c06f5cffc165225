#include "evaluate/evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/body_truth.h"
#include "evaluate/reference_motion.h"
#include "evaluate/truth.h"

namespace intaglio::evaluate {

namespace {

// The runs of a seed: the same for all representations.
struct RunPlan {
  StrokeOptions stroke;
  RollOptions roll, strike;
  std::array<ThrowOptions, 2> throws;  // a box and a hull
};

// A body that falls onto the relief, turning as it goes, and slides or tumbles on.
ThrowOptions plan_throw(BodyKind kind, double side, Random& random) {
  ThrowOptions out;
  out.kind = kind;
  const double x = random.uniform(-0.15, 0.15), y = random.uniform(-0.15, 0.15);
  const double heading = 2 * std::numbers::pi * random.uniform();
  const double speed = random.uniform(0.3, 0.6) * std::sqrt(side);
  const auto way = elementary::sin_cos(heading);
  Vec3 turn, spin;
  for (int axis = 0; axis < 3; ++axis) turn[axis] = random.uniform(-1.5, 1.5);
  for (int axis = 0; axis < 3; ++axis) spin[axis] = random.uniform(-4, 4) / std::sqrt(side);
  out.start.pose = {side * Vec3(0.5 + x, 0.5 + y, 0.065), rotation(turn)};
  out.start.velocity = speed * Vec3(way.cos, way.sin, 0);
  out.start.angular_velocity = spin;
  out.seconds = 0.6 * std::sqrt(side);
  return out;
}

std::vector<RunPlan> plan_runs(const EvaluateOptions& options) {
  Random random(options.seed);
  const double side = options.subject.size;
  std::vector<RunPlan> plans;
  for (int k = 0; k < options.runs(); ++k) {
    RunPlan plan;
    const auto direction = [&] {
      const auto turn = elementary::sin_cos(2 * std::numbers::pi * random.uniform());
      return Vec2(turn.cos, turn.sin);
    };
    // About the middle, so that they stay on the surface.
    const auto middle = [&](double reach) {
      const double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
      return Vec2(0.5 * side + x * side, 0.5 * side + y * side);
    };
    const double length = std::min(0.45 * side, 0.45);
    const Vec2 along = direction();
    const Vec2 centre = middle(0.2);
    plan.stroke.from = centre - 0.5 * length * along;
    plan.stroke.to = centre + 0.5 * length * along;
    plan.stroke.speed = random.uniform(0.1, 0.15);
    plan.stroke.load = random.uniform(0.6, 1.4);
    const Vec2 rolling = direction();
    const double speed = random.uniform(0.3, 0.6) * std::sqrt(side);
    plan.roll.from = middle(0.1) - 0.25 * side * rolling;
    plan.roll.velocity = speed * rolling;
    plan.roll.seconds = std::min(1.2, 0.6 * side / speed);
    plans.push_back(plan);
  }
  // From a stream of their own, so that strokes and rolls do not depend on them.
  Random tumbling(options.seed ^ 0x7468726f77ull);
  for (RunPlan& plan : plans) {
    plan.strike.from = side * Vec2(tumbling.uniform(0.3, 0.7), 0.5);
    plan.strike.drop = 0.1 * side;
    plan.strike.seconds = 0.5 * std::sqrt(side);
    plan.strike.restart = 1e6;  // never
    plan.throws = {plan_throw(BodyKind::box, side, tumbling), plan_throw(BodyKind::hull, side, tumbling)};
  }
  return plans;
}

struct ReferenceRun {
  Crossing stroke;
  ReferenceRoll roll, strike;
  std::array<ReferenceThrow, 2> throws;
};

// A fault of a sense along the path of this run.
class Faults {
 public:
  Faults(const scene::Cues& cues, const EvaluateOptions& options) : cues_(cues), options_(options) {}

  // Makes the subjects of the textures that faults name.
  Result<void> prepare() {
    for (const scene::Cue cue : scene::all_cues) {
      const auto& texture = cues_[cue].texture;
      if (!texture || others_.contains(*texture)) continue;
      SubjectOptions other = options_.subject;
      other.texture = *texture;
      auto subject = Subject::make(other);
      if (!subject) return tl::unexpected(subject.error());
      others_.emplace(*texture, Other{std::make_unique<Subject>(std::move(*subject)), {}});
    }
    return {};
  }

  Result<Traces> apply(Traces traces, const Candidate& candidate, const RunPlan& plan,
                       const ReferenceRun& reference) {
    const Vec2 way =
        traces.probe == Probe::pen ? Vec2(plan.stroke.to - plan.stroke.from) : plan.roll.velocity;
    for (const scene::Cue cue : scene::all_cues) {
      const scene::CueSettings& set = cues_[cue];
      const auto sense = sense_of(cue, traces.probe);
      if (!sense || set.is_true()) continue;
      StreamFault fault{
          .delay = set.delay, .shift = set.shift.dot(way.normalized()), .other = nullptr, .off = !set.on};
      std::optional<Traces> other;
      if (set.texture) {
        auto traced = trace_other(*set.texture, traces.probe, candidate, plan, reference);
        if (!traced) return tl::unexpected(traced.error());
        other = std::move(*traced);
        fault.other = &*other;
      }
      traces = with_fault(traces, *sense, fault);
    }
    return traces;
  }

 private:
  struct Other {
    std::unique_ptr<Subject> subject;
    std::map<Kind, Sight> sights;
  };

  static std::optional<Sense> sense_of(scene::Cue cue, Probe probe) {
    const bool is_pen = probe == Probe::pen;
    switch (cue) {
      case scene::Cue::picture:
        return Sense::picture;
      case scene::Cue::touch:
        return is_pen ? std::optional(Sense::touch) : std::nullopt;
      case scene::Cue::pen_sound:
        return is_pen ? std::optional(Sense::sound) : std::nullopt;
      case scene::Cue::ball_motion:
        return is_pen ? std::nullopt : std::optional(Sense::motion);
      default:
        return is_pen ? std::nullopt : std::optional(Sense::sound);
    }
  }

  Result<Traces> trace_other(const std::string& texture, Probe probe, const Candidate& candidate,
                             const RunPlan& plan, const ReferenceRun& reference) {
    Other& other = others_.at(texture);
    auto& sights = other.sights;
    if (!sights.contains(candidate.kind)) {
      auto sight = Sight::look(*other.subject, candidate, options_.quick ? 512 : 1024);
      if (!sight) return tl::unexpected(sight.error());
      sights.emplace(candidate.kind, std::move(*sight));
    }
    const Sight& sight = sights.at(candidate.kind);
    if (probe == Probe::pen)
      return make_traces(*other.subject, stroke(*other.subject, candidate, plan.stroke), reference.stroke,
                         &sight);
    return make_traces(*other.subject, roll(*other.subject, candidate, plan.roll, reference.roll),
                       reference.roll.crossing, &sight);
  }

  scene::Cues cues_;
  const EvaluateOptions& options_;
  std::map<std::string, Other> others_;
};

// Values of the runs, of which a Measured is made.
class Runs {
 public:
  void add(double value) {
    if (std::isfinite(value)) values_.push_back(value);
  }
  Measured measured() const { return {mean(values_), bootstrap_interval(values_)}; }

 private:
  std::vector<double> values_;
};

class SoundRuns {
 public:
  void add(const SoundError& error) {
    spectrum_.add(error.spectrum_db);
    loudness_.add(error.loudness_sone);
    onsets_.wanted += error.onsets.wanted;
    onsets_.missed += error.onsets.missed;
    onsets_.false_alarms += error.onsets.false_alarms;
    for (const double late : error.onsets.late_ms) late_.add(std::abs(late));
    intervals_.add(error.intervals_ms);
    decay_.add(error.decay);
  }
  SoundsTruth truth() const {
    return {spectrum_.measured(), loudness_.measured(), onsets_.wanted,        onsets_.missed,
            onsets_.false_alarms, late_.measured(),     intervals_.measured(), decay_.measured()};
  }

 private:
  Runs spectrum_, loudness_, late_, intervals_, decay_;
  OnsetMatch onsets_;
};

class Evaluator {
 public:
  explicit Evaluator(const EvaluateOptions& options) : faults_(options.faults, options) {
    out_.options = options;
  }

  Result<Evaluation> run();

 private:
  Result<void> prepare();
  void run_reference();
  Result<RepresentationResult> evaluate_one(const Candidate& candidate);
  void measure_bodies(const Candidate& candidate, MotionTruth& motion) const;
  void measure_cost(const Candidate& candidate, RepresentationResult& result) const;
  void measure_reference_error();
  void measure_body_error();
  void recommend();
  void report(double done, const std::string& what) {
    if (out_.options.progress) out_.options.progress(done, what);
  }

  Evaluation out_;
  Faults faults_;
  std::optional<Subject> subject_;
  std::vector<RunPlan> plans_;
  std::vector<Drop> drops_;
  std::vector<ReferenceRun> references_;
  std::optional<PictureReference> pictures_;
};

Result<void> Evaluator::prepare() {
  report(0, "texture");
  EvaluateOptions& options = out_.options;
  options.subject.grid = options.quick ? 1024 : 2048;
  auto subject = Subject::make(options.subject);
  if (!subject) return tl::unexpected(subject.error());
  subject_ = std::move(*subject);
  out_.notes = subject_->notes();
  out_.depth = subject_->reference().depth();
  const auto recipe = surface::find_recipe(options.subject.texture);
  out_.reference = recipe && *recipe ? fmt::format("the recipe's analytic field, sampled {} times a side",
                                                   options.subject.grid)
                                     : "the bicubic field of the fused height: an image has no other truth";
  plans_ = plan_runs(options);
  drops_ = plan_drops(options.seed, options.drops(), options.subject.size);
  auto pictures = PictureReference::make(*subject_, options.quick ? 256 : 480);
  if (!pictures) return tl::unexpected(pictures.error());
  pictures_.emplace(std::move(*pictures));
  return faults_.prepare();
}

void Evaluator::run_reference() {
  for (std::size_t k = 0; k < plans_.size(); ++k) {
    report(0.05 + 0.2 * double(k) / double(plans_.size()), fmt::format("reference, run {}", k + 1));
    const RunPlan& plan = plans_[k];
    ReferenceRun run{reference_stroke(*subject_, plan.stroke), reference_roll(*subject_, plan.roll), {}, {}};
    if (int(k) < out_.options.thrown()) {
      run.strike = reference_roll(*subject_, plan.strike);
      for (std::size_t body = 0; body < 2; ++body)
        run.throws[body] = reference_throw(*subject_, plan.throws[body]);
    }
    references_.push_back(std::move(run));
  }
}

// The grid's error by half the grid, the motion's by half the rate.
void Evaluator::measure_reference_error() {
  const Reference& truth = subject_->reference();
  const Candidate& ours = candidates()[std::size_t(Kind::relief)];
  const auto coarse =
      make_reference(out_.options.subject.texture, *subject_->surface(ours).surface, truth.grid() / 2);
  if (coarse) {
    Random random(7);
    double squares = 0;
    constexpr int points = 4000;
    for (int k = 0; k < points; ++k) {
      const double u = random.uniform(), v = random.uniform();
      const Vec2 p = truth.size().cwiseProduct(Vec2(u, v));
      squares += std::pow((*coarse)->height(p) - truth.height(p), 2);
    }
    out_.reference_error.height_um = 1e6 * std::sqrt(squares / points);
  }
  Runs off;
  const scene::Scene scene = subject_->scene(ours);
  const auto steps = std::size_t(0.1 * reference_rate);
  for (std::size_t k = 0; k < std::min<std::size_t>(references_.size(), 4); ++k) {
    const auto& states = references_[k].roll.states;
    for (std::size_t from = 0; from + steps < states.size(); from += steps) {
      ReferenceBall ball(truth, subject_->ball_radius(), scene.balls[0].material,
                         subject_->surface(ours).material, reference_rate / 2);
      ball.put(states[from]);
      for (std::size_t step = 0; step < steps / 2; ++step) ball.step();
      off.add(1000 * (ball.state().pose.position - states[from + steps].pose.position).norm());
    }
  }
  out_.reference_error.motion_mm = off.measured().value;
  measure_body_error();
  Runs share;
  for (std::size_t k = 0; k < plans_.size(); ++k)
    share.add(
        reference_energy_rise(*subject_, references_[k].roll.states.front(), plans_[k].roll.seconds).share);
  out_.reference_error.gained_share = share.measured().value;
}

// Boxes and hulls, by half the rate.
void Evaluator::measure_body_error() {
  Runs place, turn;
  for (std::size_t k = 0; k < std::size_t(std::min(out_.options.thrown(), 4)); ++k)
    for (const ReferenceThrow& reference : references_[k].throws) {
      const ThrowError error = half_rate_error(*subject_, reference);
      place.add(error.place_mm);
      turn.add(error.turn);
    }
  out_.reference_error.body_mm = place.measured().value;
  out_.reference_error.body_turn = turn.measured().value;
}

void add_agreement(ProbeAgreement& sum, const Agreement& run) {
  append(sum.all, run);
  sum.run_scores.push_back(run.score());
  sum.run_means.push_back(run.mean_jnd());
}

Result<RepresentationResult> Evaluator::evaluate_one(const Candidate& candidate) {
  const EvaluateOptions& options = out_.options;
  RepresentationResult result;
  result.candidate = candidate;
  auto sight =
      Sight::look(*subject_, candidate, options.quick ? 768 : 1536, &pictures_->drawn(*subject_, candidate));
  if (!sight) return tl::unexpected(sight.error());
  auto picture = measure_picture(*subject_, candidate, *sight, *pictures_);
  if (!picture) return tl::unexpected(picture.error());
  result.picture = *picture;
  Runs place, height, normal, force, direction, buzz, bands, steps, spectrum, loudness, pacinian,
      non_pacinian;
  SoundRuns striking, scraping, rolling;
  double touch_cost = 0, motion_cost = 0, sound_cost = 0;
  for (std::size_t k = 0; k < plans_.size(); ++k) {
    const ReferenceRun& reference = references_[k];
    const Crossing pen = stroke(*subject_, candidate, plans_[k].stroke);
    const Crossing ball = roll(*subject_, candidate, plans_[k].roll, reference.roll);
    auto pen_traces = faults_.apply(make_traces(*subject_, pen, reference.stroke, &*sight), candidate,
                                    plans_[k], reference);
    if (!pen_traces) return tl::unexpected(pen_traces.error());
    auto ball_traces = faults_.apply(make_traces(*subject_, ball, reference.roll.crossing, &*sight),
                                     candidate, plans_[k], reference);
    if (!ball_traces) return tl::unexpected(ball_traces.error());
    add_agreement(result.pen, measure_agreement(*pen_traces, options.thresholds));
    add_agreement(result.ball, measure_agreement(*ball_traces, options.thresholds));
    if (k == 0) result.example = std::move(*pen_traces);
    const TouchError touch = touch_error(pen, reference.stroke);
    force.add(touch.force_n);
    direction.add(touch.direction);
    buzz.add(touch.buzz_n);
    bands.add(touch.bands_db);
    steps.add(touch.intensity_steps);
    pacinian.add(touch.pacinian_steps);
    non_pacinian.add(touch.non_pacinian_steps);
    const MotionError motion = motion_error(ball);
    place.add(motion.place_mm);
    height.add(motion.height_mm);
    normal.add(normal_error(*subject_, candidate, reference.roll));
    const SoundError scraped = sound_error(pen, reference.stroke);
    const SoundError rolled = sound_error(ball, reference.roll.crossing);
    for (const SoundError* sound : {&scraped, &rolled}) {
      spectrum.add(sound->spectrum_db);
      loudness.add(sound->loudness_sone);
    }
    scraping.add(scraped);
    rolling.add(rolled);
    if (int(k) < options.thrown())
      striking.add(sound_error(roll(*subject_, candidate, plans_[k].strike, reference.strike),
                               reference.strike.crossing));
    touch_cost += pen.touch_cost;
    motion_cost += ball.motion_cost;
    sound_cost += 0.5 * (pen.sound_cost + ball.sound_cost);
  }
  result.motion = {place.measured(), height.measured(), normal.measured()};
  measure_bodies(candidate, result.motion);
  const double side = options.subject.size;
  result.touch = {force.measured(),
                  direction.measured(),
                  1000 * loop_energy(*subject_, candidate, {0.5 * side, 0.5 * side}, 0.05 * side),
                  buzz.measured(),
                  bands.measured(),
                  steps.measured(),
                  pacinian.measured(),
                  non_pacinian.measured()};
  result.sound = {spectrum.measured(), loudness.measured(), striking.truth(), scraping.truth(),
                  rolling.truth()};
  const auto runs = double(plans_.size());
  result.cost = {.picture_ms = 1000 * sight->cost(),
                 .motion_us = 1e6 * motion_cost / runs,
                 .touch_us = 1e6 * touch_cost / runs,
                 .sound_us = 1e6 * sound_cost / runs};
  measure_cost(candidate, result);
  return result;
}

void Evaluator::measure_bodies(const Candidate& candidate, MotionTruth& motion) const {
  for (std::size_t kind = 0; kind < 2; ++kind) {
    Runs place, height, turn, normal;
    for (std::size_t k = 0; k < std::size_t(out_.options.thrown()); ++k) {
      const ThrowError error = throw_error(*subject_, candidate, references_[k].throws[kind]);
      place.add(error.place_mm);
      height.add(error.height_mm);
      turn.add(error.turn);
      normal.add(error.normal_angle);
    }
    BodyTruth& body = kind == 0 ? motion.box : motion.hull;
    body = {place.measured(), height.measured(), turn.measured(), normal.measured()};
  }
  Runs gained, share;
  for (std::size_t k = 0; k < plans_.size(); ++k) {
    const EnergyRise rise =
        energy_rise(*subject_, candidate, references_[k].roll.states.front(), plans_[k].roll.seconds);
    gained.add(rise.gained_j);
    share.add(rise.share);
  }
  Runs height, tilt, creep;
  const std::vector<RestOfBody> dropped = rests(*subject_, candidate, drops_);
  for (const RestOfBody& rest : dropped) {
    height.add(std::abs(rest.height_mm));
    tilt.add(rest.tilt);
    creep.add(rest.creep_mm);
  }
  motion.rest = {rest_statistics(dropped), height.measured(), tilt.measured(), creep.measured()};
  motion.gained_j = gained.measured();
  motion.gained_share = share.measured();
}

void Evaluator::measure_cost(const Candidate& candidate, RepresentationResult& result) const {
  const Subject::Offline& offline = subject_->offline();
  if (const auto mesh = subject_->mesh(candidate)) {
    result.cost.runtime_bytes = mesh->bytes();
    result.cost.offline_s = mesh->build_seconds();
  } else {
    result.cost.runtime_bytes =
        candidate.kind == Kind::flat ? 0 : subject_->surface(candidate).surface->memory_bytes();
    result.cost.offline_s = candidate.kind == Kind::flat ? 0 : offline.import;
  }
}

void Evaluator::recommend() {
  const auto& all = out_.representations;
  Recommendation& choice = out_.recommendation;
  const auto best = std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    const auto cost = [](const RepresentationResult& r) {
      const double x = r.mean_jnd().value;
      return std::isfinite(x) ? x : 0.0;
    };
    return cost(a) < cost(b);
  });
  if (all[std::size_t(Kind::relief)].features() == 0) {
    choice.kind = Kind::flat;
    choice.reasons = {
        "no probe crosses a feature of 5 % of the depth: a flat surface is as true as any other"};
    return;
  }
  // The cheapest whose conflict is not distinguishable from the least.
  choice.kind = best->candidate.kind;
  const Measured least = best->mean_jnd();
  for (const Kind cheaper : {Kind::normal, Kind::relief}) {
    const Measured other = all[std::size_t(cheaper)].mean_jnd();
    if (!(other.value <= least.interval.high)) continue;
    if (choice.kind != cheaper)
      choice.reasons.push_back(fmt::format(
          "{} conflicts as little ({:.2f} of a threshold on average; the least is {:.2f}, up to {:.2f}) and costs less",
          all[std::size_t(cheaper)].candidate.title, other.value, least.value, least.interval.high));
    choice.kind = cheaper;
    break;
  }
  const RepresentationResult& chosen = all[std::size_t(choice.kind)];
  choice.reasons.insert(
      choice.reasons.begin(),
      fmt::format(
          "the senses differ by {:.2f} of what people can just notice, on average over {} features; a flat surface is at {:.2f}",
          chosen.mean_jnd().value, chosen.features(), all[0].mean_jnd().value));
}

Result<Evaluation> Evaluator::run() {
  const auto start = std::chrono::steady_clock::now();
  if (auto prepared = prepare(); !prepared) return tl::unexpected(prepared.error());
  run_reference();
  measure_reference_error();
  for (const Candidate& candidate : candidates()) {
    report(0.3 + 0.1 * double(candidate.kind), candidate.title);
    auto result = evaluate_one(candidate);
    if (!result) return tl::unexpected(result.error());
    out_.representations.push_back(std::move(*result));
  }
  recommend();
  out_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report(1, "done");
  return std::move(out_);
}

std::vector<double> concatenated(const RepresentationResult& result,
                                 std::vector<double> PairAgreement::*values) {
  std::vector<double> all;
  for (const ProbeAgreement* probe : {&result.pen, &result.ball})
    for (const PairAgreement& pair : probe->all.pairs)
      all.insert(all.end(), (pair.*values).begin(), (pair.*values).end());
  return all;
}

// The mean over both probes of each run, where it crossed anything.
Measured over_runs(const RepresentationResult& result, std::vector<double> ProbeAgreement::*values) {
  std::vector<double> runs;
  for (std::size_t k = 0; k < (result.pen.*values).size(); ++k) {
    Runs both;
    both.add((result.pen.*values)[k]);
    both.add((result.ball.*values)[k]);
    if (const double value = both.measured().value; std::isfinite(value)) runs.push_back(value);
  }
  return {mean(runs), bootstrap_interval(runs)};
}

}  // namespace

Measured RepresentationResult::score() const {
  return over_runs(*this, &ProbeAgreement::run_scores);
}

Measured RepresentationResult::mean_jnd() const {
  return over_runs(*this, &ProbeAgreement::run_means);
}

double RepresentationResult::percentile_ms(double fraction) const {
  return quantile(concatenated(*this, &PairAgreement::ms), fraction);
}

double RepresentationResult::percentile_mm(double fraction) const {
  return quantile(concatenated(*this, &PairAgreement::mm), fraction);
}

double RepresentationResult::percentile_jnd(double fraction) const {
  return quantile(concatenated(*this, &PairAgreement::jnd), fraction);
}

std::size_t RepresentationResult::missed() const {
  return pen.all.missed + ball.all.missed;
}

std::size_t RepresentationResult::false_alarms() const {
  return pen.all.false_alarms + ball.all.false_alarms;
}

std::size_t RepresentationResult::features() const {
  return pen.all.features.size() + ball.all.features.size();
}

double displayed_late(Sense sense) {
  constexpr std::array<double, senses> late = {1.0 / 60, 0.001, 1.0 / 60, 512.0 / 44100};
  return late[std::size_t(sense)];
}

double RepresentationResult::displayed_ms() const {
  std::vector<double> all;
  for (const ProbeAgreement* probe : {&pen, &ball})
    for (const FeatureCrossed& feature : probe->all.features)
      for (const PairAgreement& pair : probe->all.pairs) {
        const auto a = feature.delay[std::size_t(pair.first)], b = feature.delay[std::size_t(pair.second)];
        if (a && b)
          all.push_back(1000 * std::abs(*a + displayed_late(pair.first) - *b - displayed_late(pair.second)));
      }
  return quantile(all, 0.95);
}

Result<Evaluation> evaluate(const EvaluateOptions& options) {
  return Evaluator(options).run();
}

}  // namespace intaglio::evaluate
