#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/text.h"
#include "evaluate/evaluation.h"
#include "intaglio/version.h"

namespace intaglio::evaluate {

namespace {

// Declared before the templates that call them.
std::string json(const Measured& measured);
std::string json(const PairAgreement& pair);
std::string json(const ProbeAgreement& probe);
std::string json(const Threshold& threshold);

std::string json(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

std::string json(std::size_t value) {
  return std::to_string(value);
}

std::string json(bool value) {
  return value ? "true" : "false";
}

std::string json(std::string_view value) {
  return json_quoted(value);
}

std::string json(const Interval& interval) {
  return fmt::format("[{}, {}]", json(interval.low), json(interval.high));
}

template <class Value>
std::string json(const std::vector<Value>& values) {
  std::vector<std::string> items;
  for (const Value& value : values) items.push_back(json(value));
  return fmt::format("[{}]", fmt::join(items, ", "));
}

// Members in order; each value is already JSON.
class JsonObject {
 public:
  template <class Value>
  JsonObject& add(std::string_view key, const Value& value) {
    return add_json(key, json(value));
  }
  JsonObject& add_json(std::string_view key, const std::string& value) {
    fmt::format_to(std::back_inserter(members_), "{}{}: {}", members_.empty() ? "" : ", ", json_quoted(key),
                   value);
    return *this;
  }
  std::string text() const { return "{" + members_ + "}"; }

 private:
  std::string members_;
};

std::string json(const Measured& measured) {
  return JsonObject().add("value", measured.value).add("interval", measured.interval).text();
}

std::string percentiles(double p50, double p95) {
  return JsonObject().add("p50", p50).add("p95", p95).text();
}

std::string percentiles(const std::vector<double>& values) {
  return percentiles(quantile(values, 0.5), quantile(values, 0.95));
}

std::string json(const PairAgreement& pair) {
  return JsonObject()
      .add("first", std::string_view(name_of(pair.first)))
      .add("second", std::string_view(name_of(pair.second)))
      .add_json("ms", percentiles(pair.ms))
      .add_json("mm", percentiles(pair.mm))
      .add_json("jnd", JsonObject().add("mean", mean(pair.jnd)).add("p95", quantile(pair.jnd, 0.95)).text())
      .add("missed", pair.missed)
      .text();
}

std::string json(const ProbeAgreement& probe) {
  return JsonObject()
      .add("features", probe.all.features.size())
      .add("missed", probe.all.missed)
      .add("false_alarms", probe.all.false_alarms)
      .add("score", probe.all.score())
      .add("mean_jnd", probe.all.mean_jnd())
      .add("run_scores", probe.run_scores)
      .add("run_means", probe.run_means)
      .add("pairs", probe.all.pairs)
      .text();
}

std::string agreement_json(const RepresentationResult& result) {
  const Measured x = result.mean_jnd(), score = result.score();
  return JsonObject()
      .add_json("ms", percentiles(result.percentile_ms(0.5), result.percentile_ms(0.95)))
      .add_json("mm", percentiles(result.percentile_mm(0.5), result.percentile_mm(0.95)))
      .add_json("jnd", JsonObject()
                           .add("mean", x.value)
                           .add("mean_interval", x.interval)
                           .add("p95", result.percentile_jnd(0.95))
                           .text())
      .add("features", result.features())
      .add("missed", result.missed())
      .add("false_alarms", result.false_alarms())
      .add("score", score.value)
      .add("score_interval", score.interval)
      .add("displayed_ms", result.displayed_ms())
      .add("pen", result.pen)
      .add("ball", result.ball)
      .text();
}

std::string json(const PictureTruth& picture) {
  return JsonObject()
      .add("depth_mm", picture.depth_mm)
      .add("normal_angle", picture.normal_angle)
      .add("silhouette", picture.silhouette)
      .add("flip", picture.flip)
      .text();
}

std::string json(const BodyTruth& body) {
  return JsonObject()
      .add("place_mm", body.place_mm)
      .add("height_mm", body.height_mm)
      .add("turn", body.turn)
      .add("normal_angle", body.normal_angle)
      .text();
}

std::string json(const RestTruth& rest) {
  return JsonObject()
      .add("bodies", rest.all.bodies)
      .add("at_rest", rest.all.at_rest)
      .add("height_mm", rest.height_mm)
      .add("tilt", rest.tilt)
      .add("sunk", rest.all.sunk)
      .add("creep_mm", rest.creep_mm)
      .text();
}

std::string json(const MotionTruth& motion) {
  return JsonObject()
      .add("place_mm", motion.place_mm)
      .add("height_mm", motion.height_mm)
      .add("normal_angle", motion.normal_angle)
      .add_json("box", json(motion.box))
      .add_json("hull", json(motion.hull))
      .add("gained_j", motion.gained_j)
      .add("gained_share", motion.gained_share)
      .add_json("rest", json(motion.rest))
      .text();
}

std::string json(const TouchTruth& touch) {
  return JsonObject()
      .add("force_n", touch.force_n)
      .add("direction", touch.direction)
      .add("loop_energy_mj", touch.loop_energy_mj)
      .add("buzz_n", touch.buzz_n)
      .add("bands_db", touch.bands_db)
      .add("intensity_steps", touch.intensity_steps)
      .add("pacinian_steps", touch.pacinian_steps)
      .add("non_pacinian_steps", touch.non_pacinian_steps)
      .text();
}

std::string json(const SoundsTruth& sounds) {
  return JsonObject()
      .add("spectrum_db", sounds.spectrum_db)
      .add("loudness_sone", sounds.loudness_sone)
      .add("onsets", sounds.onsets)
      .add("missed", sounds.missed)
      .add("false_alarms", sounds.false_alarms)
      .add("late_ms", sounds.late_ms)
      .add("intervals_ms", sounds.intervals_ms)
      .add("decay", sounds.decay)
      .text();
}

std::string json(const SoundTruth& sound) {
  return JsonObject()
      .add("spectrum_db", sound.spectrum_db)
      .add("loudness_sone", sound.loudness_sone)
      .add_json("striking", json(sound.striking))
      .add_json("scraping", json(sound.scraping))
      .add_json("rolling", json(sound.rolling))
      .text();
}

std::string cost_json(const RepresentationResult& result) {
  const Cost& cost = result.cost;
  return JsonObject()
      .add("picture_ms", cost.picture_ms)
      .add("motion_us", cost.motion_us)
      .add("touch_us", cost.touch_us)
      .add("sound_us", cost.sound_us)
      .add("runtime_bytes", cost.runtime_bytes)
      .add("device_bytes", result.picture.device_bytes)
      .add("offline_s", cost.offline_s)
      .text();
}

std::string json(const RepresentationResult& result) {
  return fmt::format(
      "{{\n      \"picture\": {},\n      \"motion\": {},\n      \"touch\": {},\n      \"sound\": {},\n"
      "      \"agreement\": {},\n      \"cost\": {}}}",
      json(result.picture), json(result.motion), json(result.touch), json(result.sound),
      agreement_json(result), cost_json(result));
}

std::string json(const Threshold& threshold) {
  return JsonObject()
      .add("pair", name_of(threshold.pair))
      .add("direction", name_of(threshold.first))
      .add("value", threshold.value)
      .add_json("spread", json(Interval{threshold.low, threshold.high}))
      .add("condition", std::string_view(threshold.condition))
      .add("source", std::string_view(threshold.source))
      .text();
}

std::string json(const Recommendation& recommendation) {
  std::vector<std::string_view> reasons(recommendation.reasons.begin(), recommendation.reasons.end());
  return JsonObject()
      .add("representation", std::string_view(candidates()[std::size_t(recommendation.kind)].key))
      .add("reasons", reasons)
      .text();
}

}  // namespace

std::string evaluation_json(const Evaluation& evaluation) {
  const EvaluateOptions& options = evaluation.options;
  std::vector<std::string> results;
  for (const RepresentationResult& result : evaluation.representations)
    results.push_back(fmt::format("    {}: {}", json_quoted(result.candidate.key), json(result)));
  std::string out = "{\n";
  const auto add = [&](std::string_view key, const std::string& value) {
    fmt::format_to(std::back_inserter(out), "  {}: {},\n", json_quoted(key), value);
  };
  const std::vector<std::string_view> notes(evaluation.notes.begin(), evaluation.notes.end());
  add("version", json_quoted(version()));
  add("surface", json_quoted(options.subject.texture));
  add("size", json(options.subject.size));
  add("depth", json(evaluation.depth));
  add("seeds", std::to_string(options.runs()));
  add("seed", std::to_string(options.seed));
  add("quick", json(options.quick));
  add("faults", json_quoted(scene::fault_text(options.faults)));
  add("notes", json(notes));
  add("reference", JsonObject()
                       .add("what", std::string_view(evaluation.reference))
                       .add("height_um", evaluation.reference_error.height_um)
                       .add("motion_mm", evaluation.reference_error.motion_mm)
                       .add("body_mm", evaluation.reference_error.body_mm)
                       .add("body_turn", evaluation.reference_error.body_turn)
                       .add("gained_share", evaluation.reference_error.gained_share)
                       .text());
  add("representations", fmt::format("{{\n{}}}", fmt::join(results, ",\n")));
  add("recommendation", json(evaluation.recommendation));
  add("thresholds",
      JsonObject().add("times", options.thresholds.times).add("places", options.thresholds.places).text());
  out += fmt::format("  \"seconds\": {}\n}}\n", json(evaluation.seconds));
  return out;
}

}  // namespace intaglio::evaluate
