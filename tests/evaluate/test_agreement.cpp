#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/bootstrap.h"
#include "evaluate/agreement.h"
#include "evaluate/delay.h"
#include "report/percepts.h"
#include "surface/recipes/builtin.h"

namespace intaglio::evaluate {

namespace {

// Senses that deliver exactly what the reference does, along a path at constant speed with irregular bumps.
// Synthetic.
Traces perfect(Probe probe, double speed = 0.12) {
  Traces traces;
  traces.probe = probe;
  traces.rate = 2000;
  const std::size_t length = 5000;
  std::vector<double> slope(length, 0.0), change(length, 0.0);
  for (int bump = 0; bump < 12; ++bump) {
    const double at = 500 + 340 * bump + 90 * std::sin(7.0 * bump), width = 30 + 5 * (bump % 4);
    for (std::size_t k = 0; k < length; ++k) {
      const double x = (double(k) - at) / width;
      slope[k] += (0.5 + 0.1 * (bump % 3)) * -x * std::exp(-0.5 * x * x);
      change[k] += std::exp(-0.5 * std::pow((double(k) - at) / 6, 2));
    }
    if (at > 400 && at < 4500) traces.features.push_back(std::size_t(at));
  }
  for (std::size_t k = 0; k < length; ++k) traces.distance.push_back(speed * double(k) / traces.rate);
  traces.of[std::size_t(Sense::picture)] = {slope, slope};
  traces.of[std::size_t(probe == Probe::pen ? Sense::touch : Sense::motion)] = {slope, slope};
  traces.of[std::size_t(Sense::sound)] = {change, change};
  return traces;
}

double mean_x(const Traces& traces) {
  return measure_agreement(traces, builtin_thresholds()).mean_jnd();
}

std::vector<Sense> senses_of(Probe probe) {
  return {Sense::picture, probe == Probe::pen ? Sense::touch : Sense::motion, Sense::sound};
}

}  // namespace

TEST_CASE("A perfect case has no conflict") {
  for (const Probe probe : {Probe::pen, Probe::ball}) {
    const Agreement agreement = measure_agreement(perfect(probe), builtin_thresholds());
    CHECK(agreement.features.size() >= 10);
    CHECK(agreement.mean_jnd() < 1e-6);  // rounding: 10 ns
    CHECK(agreement.score() == 0);
    CHECK(agreement.missed == 0);
    CHECK(agreement.false_alarms == 0);
  }
}

TEST_CASE("A delay is measured to a tenth of a millisecond, and the conflict rises with it") {
  for (const Probe probe : {Probe::pen, Probe::ball}) {
    for (const Sense sense : senses_of(probe)) {
      CAPTURE(name_of(sense));
      double before = 0;
      for (const double ms : {5.0, 20.0, 40.0, 60.0, 90.0}) {
        CAPTURE(ms);
        const Traces late = with_fault(perfect(probe), sense, {.delay = ms / 1000});
        const Agreement agreement = measure_agreement(late, builtin_thresholds());
        for (const FeatureCrossed& feature : agreement.features) {
          REQUIRE(feature.delay[std::size_t(sense)]);
          CHECK(std::abs(1000 * *feature.delay[std::size_t(sense)] - ms) < 0.1);
        }
        CHECK(agreement.mean_jnd() > before);
        before = agreement.mean_jnd();
      }
    }
  }
}

TEST_CASE("Conflicts are noticed as the literature says") {
  const Traces pen = perfect(Probe::pen, 0.1);
  const auto score = [&](Sense sense, const StreamFault& fault) {
    return measure_agreement(with_fault(pen, sense, fault), builtin_thresholds()).score();
  };
  CHECK(score(Sense::sound, {.delay = 0.02}) == 0);
  CHECK(score(Sense::touch, {.delay = 0.02}) == 0);
  // Touch comes first: 15 ms are noticed.
  CHECK(score(Sense::picture, {.delay = 0.02}) == 1);
  for (const Sense sense : {Sense::picture, Sense::touch, Sense::sound})
    CHECK(score(sense, {.delay = 0.06}) == 1);
  CHECK(score(Sense::touch, {.shift = 0.001}) == 0);
  CHECK(score(Sense::touch, {.shift = 0.010}) == 1);
}

TEST_CASE("The score is blind to no sense") {
  for (const Probe probe : {Probe::pen, Probe::ball}) {
    for (const Sense sense : senses_of(probe)) {
      CAPTURE(name_of(sense));
      const Agreement off =
          measure_agreement(with_fault(perfect(probe), sense, {.off = true}), builtin_thresholds());
      CHECK(off.score() == 1);
      CHECK(off.missed == off.features.size());
      // Another texture: the same bumps elsewhere.
      Traces other = perfect(probe);
      for (auto& series : other.of)
        if (series) {
          auto& values = series->delivered;
          std::reverse(values.begin(), values.end());
        }
      CHECK(mean_x(with_fault(perfect(probe), sense, {.other = &other})) > 1);
    }
  }
}

TEST_CASE("Single delays are separated from the noise of the series that they are measured in") {
  // Bumps that are early or late by up to 8 ms, each for itself, under noise: synthetic.
  constexpr double rate = 2000;
  constexpr int bumps = 24, apart = 400;
  std::vector<double> true_lag, reference, delivered;
  std::uint32_t seed = 5;
  const auto random = [&] {
    seed = seed * 1664525u + 1013904223u;
    return double(seed >> 8) / double(1u << 24) - 0.5;
  };
  for (int bump = 0; bump < bumps; ++bump) true_lag.push_back(32 * random());
  double noise = 0;
  for (int k = 0; k < apart * bumps; ++k) {
    const auto bump = std::size_t(k / apart);
    const double at = apart * (double(bump) + 0.5);
    const auto slope = [](double x) { return -x * std::exp(-0.5 * x * x); };
    reference.push_back(slope((k - at) / 30));
    noise = 0.9 * noise + 0.1 * random();
    delivered.push_back(slope((k - at - true_lag[bump]) / 30) + noise);
  }
  std::vector<Lag> found;
  double raw = 0, drawn = 0, spread = 0, expected = 0, error = 0;
  for (int bump = 0; bump < bumps; ++bump) {
    const std::int64_t middle = apart * bump + apart / 2;
    found.push_back(best_lag(reference, delivered, middle - 120, middle + 120, 0, 40));
  }
  const std::vector<double> together = drawn_together(found, 0);
  for (std::size_t bump = 0; bump < bumps; ++bump) {
    raw += std::pow(found[bump].values - true_lag[bump], 2) / bumps;
    drawn += std::pow(together[bump] - true_lag[bump], 2) / bumps;
    spread += together[bump] * together[bump] / bumps;
    expected += true_lag[bump] * true_lag[bump] / bumps;
    error += found[bump].error * found[bump].error / bumps;
  }
  MESSAGE(fmt::format(
      "spread {:.2f} ms, found {:.2f} ms; error {:.2f} ms, drawn together {:.2f}, said {:.2f}",
      1000 / rate * std::sqrt(expected), 1000 / rate * std::sqrt(spread), 1000 / rate * std::sqrt(raw),
      1000 / rate * std::sqrt(drawn), 1000 / rate * std::sqrt(error)));
  CHECK(std::sqrt(spread / expected) > 0.8);
  CHECK(std::sqrt(spread / expected) < 1.2);
  CHECK(drawn < 1.1 * raw);
  CHECK(std::sqrt(error / raw) > 0.5);
  CHECK(std::sqrt(error / raw) < 2);
}

TEST_CASE("On the reference itself, seen by its true slopes, the meter reads little") {
  // Brick: 3 s, because the reference is made first. The remainder is the tip: the reference's dilates.
  const auto subject = Subject::make(SubjectOptions());
  REQUIRE(subject);
  const Crossing stroke = reference_stroke(*subject, {.from = {0.2, 0.3}, .to = {0.6, 0.5}, .speed = 0.12});
  const double x = mean_x(reference_traces(*subject, stroke));
  MESSAGE(fmt::format("mean x {:.3f}", x));
  CHECK(x < 0.3);
}

TEST_CASE("An excitation far from any feature is a false alarm") {
  Traces traces = perfect(Probe::pen);
  traces.features.clear();
  CHECK(measure_agreement(traces, builtin_thresholds()).false_alarms >= 10);
}

TEST_CASE("Faults of recorded senses raise the conflict of a built-in material" *
          doctest::test_suite("statistics")) {
  // All sixteen materials by command (INTAGLIO_SLOW=1); here one, 16 cases. 10 s, because the real senses are
  // recorded first.
  const bool all = std::getenv("INTAGLIO_SLOW") != nullptr;
  const std::vector<std::string> materials =
      all ? surface::builtin_names() : std::vector<std::string>{"brick_running"};
  const Candidate& ours = candidates()[std::size_t(Kind::relief)];
  int cases = 0;
  for (const std::string& material : materials) {
    CAPTURE(material);
    SubjectOptions options;
    options.texture = material;
    const auto subject = Subject::make(options);
    REQUIRE(subject);
    const auto sight = Sight::look(*subject, ours, 512);
    REQUIRE(sight);
    const StrokeOptions way{.from = {0.2, 0.3}, .to = {0.6, 0.5}, .speed = 0.12};
    const Traces pen =
        make_traces(*subject, stroke(*subject, ours, way), reference_stroke(*subject, way), &*sight);
    const double true_x = mean_x(pen);
    if (!std::isfinite(true_x)) continue;  // it crosses nothing of 5 % of the depth
    for (const Sense sense : {Sense::picture, Sense::touch, Sense::sound}) {
      CAPTURE(name_of(sense));
      double before = true_x;
      for (const double ms : {30.0, 50.0, 70.0}) {
        CAPTURE(ms);
        const double x = mean_x(with_fault(pen, sense, {.delay = ms / 1000}));
        CHECK(x > before);
        before = x;
        ++cases;
      }
      CHECK(mean_x(with_fault(pen, sense, {.shift = 0.01})) > true_x);
      CHECK(mean_x(with_fault(pen, sense, {.off = true})) > std::max(true_x, 1.9));
      cases += 2;
    }
    ++cases;
    CHECK(true_x < mean_x(make_traces(*subject, stroke(*subject, candidates()[0], way),
                                      reference_stroke(*subject, way), &*sight)));
  }
  MESSAGE(fmt::format("{} cases of {} materials", cases, materials.size()));
}

}  // namespace intaglio::evaluate
