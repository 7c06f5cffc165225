// An evaluation that nobody measured: invented values and traces of the right form, for tests of pages and
// files. Deterministic.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "evaluate/evaluation.h"

namespace intaglio::tests {

// Faults of a representation: delays (s) of picture, touch or motion, sound; a gain of 0 delivers nothing.
struct Invented {
  double picture = 0, touch = 0, sound = 0;
  double picture_gain = 1, touch_gain = 1, error = 0.1;
};

inline evaluate::Traces invented_traces(const Invented& how, evaluate::Probe probe, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return double(random()) / 4294967296.0; };
  evaluate::Traces out;
  out.probe = probe;
  out.rate = 2000;
  out.start = 0.4;
  constexpr std::size_t length = 4000;
  for (std::size_t k = 0; k < length; ++k) out.distance.push_back(0.13 * double(k) / out.rate);
  struct Bump {
    double at, width, height;
  };
  std::vector<Bump> bumps;
  for (double t = 0.12; t < 1.9; t += 0.05 + 0.09 * uniform()) {
    bumps.push_back({t, 0.008 + 0.008 * uniform(), (uniform() < 0.5 ? -1 : 1) * (0.4 + 0.5 * uniform())});
    out.features.push_back(std::size_t(t * out.rate));
  }
  const auto lean = [&](double t) {
    double sum = 0;
    for (const Bump& b : bumps)
      sum += b.height * (t - b.at) / b.width * std::exp(-0.5 * std::pow((t - b.at) / b.width, 2));
    return 0.5 * sum;
  };
  const auto hit = [&](double t) {
    double sum = 0;
    for (const Bump& b : bumps) sum += std::abs(b.height) * std::exp(-0.5 * std::pow((t - b.at) / 0.004, 2));
    return sum;
  };
  const auto series = [&](const auto& truth, double delay, double gain, double offset, double noise) {
    evaluate::Traces::Series s;
    for (std::size_t k = 0; k < length; ++k) {
      const double t = double(k) / out.rate;
      s.reference.push_back(truth(t));
      s.delivered.push_back(offset +
                            gain * (truth(t - delay) + noise * std::sin(160 * t) * std::sin(37 * t)));
    }
    return s;
  };
  using evaluate::Sense;
  const Sense moved = probe == evaluate::Probe::pen ? Sense::touch : Sense::motion;
  out.of[std::size_t(Sense::picture)] = series(lean, how.picture, how.picture_gain, 0, how.error);
  out.of[std::size_t(moved)] = series(lean, how.touch, how.touch_gain, 0.2, how.error);
  out.of[std::size_t(Sense::sound)] = series(hit, how.sound, 3, 0, 0.5 * how.error);
  return out;
}

inline evaluate::Measured invented_measure(double value) {
  return {value, {0.83 * value, 1.21 * value}};
}

inline evaluate::RepresentationResult invented_result(const evaluate::Candidate& candidate,
                                                      const Invented& how,
                                                      const evaluate::Thresholds& thresholds) {
  evaluate::RepresentationResult r;
  r.candidate = candidate;
  const double e = how.error;
  r.picture = {12 * e, 31 * e, 0.04 * e, 0.21 * e, std::size_t(5e6 * (1 + e))};
  r.motion = {invented_measure(2.3 * e), invented_measure(0.6 * e), invented_measure(24 * e)};
  r.motion.box = {invented_measure(1.7 * e), invented_measure(0.9 * e), invented_measure(7 * e),
                  invented_measure(18 * e)};
  r.motion.hull = {invented_measure(1.4 * e), invented_measure(0.8 * e), invented_measure(9 * e),
                   invented_measure(15 * e)};
  r.motion.gained_j = invented_measure(0.002 * e);
  r.motion.gained_share = invented_measure(0.04 * e);
  r.touch = {invented_measure(0.35 * e), invented_measure(28 * e), 0.4 * e - 0.05,
             invented_measure(0.06 * e), invented_measure(9 * e),  invented_measure(2.5 * e)};
  r.touch.pacinian_steps = invented_measure(2.1 * e);
  r.touch.non_pacinian_steps = invented_measure(1.2 * e);
  r.motion.rest.all = {102, 1 - 0.3 * e, 1.1 * e, 2.5 * e, 0.2 * e, 0.05 * e};
  r.motion.rest.height_mm = invented_measure(1.1 * e);
  r.motion.rest.tilt = invented_measure(2.5 * e);
  r.motion.rest.creep_mm = invented_measure(0.05 * e);
  const auto sounds = [&](double more) {
    return evaluate::SoundsTruth{invented_measure(7 * e * more),
                                 invented_measure(2 * e * more),
                                 40,
                                 std::size_t(12 * e),
                                 std::size_t(9 * e * more),
                                 invented_measure(4 * e * more),
                                 invented_measure(6 * e),
                                 invented_measure(0.2 * e * more)};
  };
  r.sound = {invented_measure(8 * e), invented_measure(3 * e), sounds(1), sounds(2), sounds(1.5)};
  r.cost = {40 + 90 * (1 - e), 22, 14.5, 61, std::size_t(8e6 * (1 + e)), 0.8};
  const auto add = [&](evaluate::ProbeAgreement& to, const evaluate::Traces& traces) {
    const evaluate::Agreement run = evaluate::measure_agreement(traces, thresholds);
    evaluate::append(to.all, run);
    to.run_scores.push_back(run.score());
    to.run_means.push_back(run.mean_jnd());
  };
  for (std::uint32_t k = 0; k < 4; ++k) {
    evaluate::Traces pen = invented_traces(how, evaluate::Probe::pen, 7 + k);
    add(r.pen, pen);
    add(r.ball, invented_traces(how, evaluate::Probe::ball, 70 + k));
    if (k == 0) r.example = std::move(pen);
  }
  return r;
}

inline evaluate::Evaluation synthetic_evaluation(const std::string& texture = "a synthetic texture") {
  evaluate::Evaluation out;
  out.options.subject.texture = texture;
  out.options.quick = true;
  out.depth = 0.0123;
  out.reference = "a synthetic reference that nobody measured";
  out.reference_error = {1.4, 0.021, 0.33, 0.8, 0.0003};
  out.notes = {"synthetic: all values are invented"};
  out.seconds = 41.7;
  constexpr Invented how[] = {{0, 0, 0.001, 0, 0, 1},
                              {0, 0.014, 0.024, 1, 0.8, 0.7},
                              {0, 0.004, 0.006, 1, 0.9, 0.42},
                              {0, 0.006, 0.016, 0.9, 1, 0.5},
                              {0, 0.0006, 0.0021, 1, 1, 0.11},
                              {0.002, 0.003, 0.013, 0.6, 0.8, 0.6},
                              {0.001, 0.001, 0.006, 0.8, 0.9, 0.35}};
  for (std::size_t k = 0; k < evaluate::kinds; ++k)
    out.representations.push_back(invented_result(evaluate::candidates()[k], how[k], out.options.thresholds));
  out.recommendation = {
      evaluate::Kind::relief,
      {"the senses differ by 0.13 of what people can just notice, on average over 154 features; a "
       "flat surface is at 2.41"}};
  return out;
}

}  // namespace intaglio::tests
