// Everything that is kept of a session while it runs: files, and the digest that the report is made of.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/file.h"
#include "core/file_stream.h"
#include "core/portable_math.h"
#include "haptics/haptic_log.h"
#include "report/bounded.h"
#include "report/digest.h"
#include "report/report.h"
#include "report/time_spans.h"
#include "session/result_files.h"
#include "session/simulation.h"
#include "sound/audio/wav.h"
#include "tests/count_allocations.h"
#include "tests/sampling.h"
#include "tests/session/sessions.h"

using namespace intaglio;
using namespace intaglio::report;
using namespace intaglio::session;

namespace {

// A ball that lands and rolls, and a pen that touches for some time.
scene::Scene short_scene() {
  scene::Scene scene = tests::parsed(
      "duration = 1.3\n[[ball]]\nradius = 0.04\nposition = [0.0, 0.15, 0.0]\nvelocity = [0.3, 0, 0]\n"
      "[pen]\npath = [[0, -0.02, 0.01, 0], [0.3, -0.02, -0.01, 0], [1.2, 0.06, -0.01, 0.02]]\n");
  scene.sound.modes = 30;
  return scene;
}

std::string page_of(const Digest& digest) {
  std::string page;
  REQUIRE(write_report(digest, {}, [&](std::string_view text) { page += text; }));
  return page;
}

// Bytes that a digest holds after a busy session, whose data are made up and kept nowhere: two balls that
// strike and roll, a pen that taps, noise with clicks.
std::size_t digest_bytes(double seconds) {
  Run run;
  run.duration = seconds;
  run.sample_rate = 8000;
  run.balls = {{1, 0.04}, {2, 0.05}};
  run.pen = 3;
  const std::size_t before = held_bytes();
  Digest digest(run);
  Random random(7);
  for (std::int64_t k = 0; k < std::int64_t(seconds * 1000); ++k) {
    haptics::ServoSample sample;
    sample.tip = {0.1 * std::sin(1e-3 * double(k)), 0, 0.1};
    sample.touching = k % 500 < 300;
    sample.force = {0, random.uniform(0, 1), 0};
    digest.on_tick(sample);
    if (k % 2 == 0) digest.on_step(std::vector<Vec3>{sample.tip, {0, random.uniform(0, 1), 0}});
    ContactEvent event;
    event.time = 1e-3 * double(k + 1);
    event.duration = 1e-3;
    event.body = k % 3 == 0 ? 3 : 1 + k % 2;
    event.phase = k % 100 < 3 ? ContactPhase::begin : ContactPhase::persist;
    event.impulse = {0, random.uniform(0, 1), 0};
    digest.on_event(event);
    std::vector<float> sound(16, k % 40 == 0 ? 0.3F : 1e-3F * float(random.normal()));
    digest.on_sound(sound);
  }
  digest.finish();
  return held_bytes() - before;
}

}  // namespace

TEST_CASE("a digest of ten minutes takes the memory of one of a minute") {
  const double seconds = tests::is_sampled() ? 6 : 60;
  const std::size_t minute = digest_bytes(seconds), ten_minutes = digest_bytes(10 * seconds);
  MESSAGE("a minute " << minute << " bytes, ten " << ten_minutes);
  CHECK(minute < 16'000'000);
  CHECK(double(ten_minutes) < 1.01 * double(minute));
}

TEST_CASE("the report of a run that is not kept is that of its recording, to the byte") {
  const scene::Scene scene = short_scene();
  const auto surface = scene::make_surface(scene);
  REQUIRE(surface);
  auto simulation = Simulation::create(scene, *surface, tests::cached_models());
  REQUIRE(simulation);
  Digest streamed((*simulation)->run());
  Recording recording;
  (*simulation)->add_observer(streamed);
  (*simulation)->add_observer(recording);
  (*simulation)->finish();
  streamed.finish();
  static_cast<Run&>(recording) = (*simulation)->run();
  CHECK(recording.event_count == recording.events.size());
  CHECK(recording.events.size() > 1000);
  CHECK(page_of(streamed) == page_of(*digest_of(recording)));
}

TEST_CASE("files that are written while a scene runs are those of its recording") {
  const scene::Scene scene = short_scene();
  const auto surface = scene::make_surface(scene);
  REQUIRE(surface);
  auto simulation = Simulation::create(scene, *surface, tests::cached_models());
  REQUIRE(simulation);
  const tests::TemporaryFolder folder;
  OutputFiles files;
  const auto results = ResultFiles::create(files, folder.path / "a.mp4", (*simulation)->run());
  REQUIRE(results);
  Recording recording;
  (*simulation)->add_observer(**results);
  (*simulation)->add_observer(recording);
  (*simulation)->finish();
  REQUIRE((*results)->check());
  REQUIRE((*results)->finish());
  REQUIRE(files.commit());
  static_cast<Run&>(recording) = (*simulation)->run();

  CHECK(read_text(folder.path / "a.events.csv", 1u << 30).value() == events_csv(recording));
  CHECK(read_text(folder.path / "a.servo.csv", 1u << 30).value() ==
        haptics::encode_log(recording.servo_rate, recording.texture, haptics::fingerprint(*recording.surface),
                            recording.servo));
  REQUIRE(sound::write_wav(folder.path / "b.wav", recording.stereo, recording.sample_rate, {.channels = 2}));
  CHECK(read_file(folder.path / "a.wav", 1u << 30).value() ==
        read_file(folder.path / "b.wav", 1u << 30).value());
}

TEST_CASE("a file that is written piece by piece is all of its pieces") {
  OutputFiles files;
  const tests::TemporaryFolder folder;
  auto stream = FileStream::create(files, folder.path / "a.csv");
  REQUIRE(stream);
  std::string all;
  for (int k = 0; k < 30'000; ++k) {
    const std::string piece = std::to_string(k) + "\n";
    stream->write(piece);
    all += piece;
  }
  CHECK_FALSE(stream->error());
  CHECK(stream->finish());
  REQUIRE(files.commit());
  CHECK(read_text(folder.path / "a.csv", 1u << 30).value() == all);
}

TEST_CASE("a union of spans of time is that of their instants") {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    TimeSpans spans(100);
    std::vector<bool> covered(100, false);
    for (int k = 0; k < 1 + round; ++k) {
      const int begin = int(random.uniform(-20, 110)), end = begin + int(random.uniform(-3, 12));
      spans.add({double(begin), double(end)});
      for (int t = std::max(begin, 0); t < std::min(end, 100); ++t) covered[std::size_t(t)] = true;
    }
    const auto expected = double(std::count(covered.begin(), covered.end(), true));
    CHECK(spans.total() == expected);
    for (const TimeSpan& span : spans.spans()) CHECK(span.begin < span.end);
    for (std::size_t k = 1; k < spans.spans().size(); ++k)
      CHECK(spans.spans()[k - 1].end < spans.spans()[k].begin);
    spans.forget_before(50);
    CHECK(spans.total() == expected);
  }
}

TEST_CASE("bounded lists keep the strongest, evenly spaced samples, and all of some windows of time") {
  Random random(5);
  Strongest<int> strongest(10);
  std::vector<std::pair<double, int>> all;
  for (int k = 0; k < 1000; ++k) {
    const double strength = std::floor(random.uniform(0, 50));
    strongest.add(strength, std::size_t(k), k);
    all.emplace_back(-strength, k);
  }
  std::sort(all.begin(), all.end());
  const std::vector<int> kept = strongest.sorted();
  REQUIRE(kept.size() == 10);
  for (std::size_t k = 0; k < 10; ++k) CHECK(kept[k] == all[k].second);

  for (const int count : {0, 7, 64, 65, 1000, 4097}) {
    Decimated<int> decimated(64);
    for (int k = 0; k < count; ++k) decimated.add(k);
    const std::vector<int>& samples = decimated.samples();
    CHECK(samples.size() <= 64);
    CHECK(int(samples.size()) >= std::min(count, 32));
    for (std::size_t k = 1; k < samples.size(); ++k) CHECK(samples[k] == int(k) * samples[1]);
    if (count <= 64) CHECK(int(samples.size()) == count);
  }

  struct Moment {
    double time;
  };
  TimeSample<Moment> sample(1000);
  for (int k = 0; k < 100'000; ++k) sample.add({0.05 * k}, [](const Moment&) { return true; });
  CHECK(sample.kept().size() <= 2000);
  CHECK(sample.stride() > 1);
  const double per_second = double(sample.kept().size()) / covered_time(5000, sample.stride());
  CHECK(per_second == doctest::Approx(20).epsilon(0.01));
}

TEST_CASE("the cost of steps has exact totals, and quantiles within one per cent") {
  CostMeter meter;
  Random random(9);
  std::vector<double> costs;
  std::int64_t total = 0;
  for (int k = 0; k < 5001; ++k) {
    const auto ns = std::int64_t(std::exp(random.uniform(5, 18)));
    costs.push_back(1e-3 * double(ns));
    total += ns;
    meter.add(ns);
  }
  std::sort(costs.begin(), costs.end());
  const SenseCost cost = meter.summarise({});
  CHECK(cost.steps == 5001);
  CHECK(cost.total_s == double(total) * 1e-9);
  CHECK(cost.median_us == doctest::Approx(costs[2500]).epsilon(0.01));
  CHECK(cost.p99_us == doctest::Approx(costs[4950]).epsilon(0.01));
  CHECK(CostMeter().summarise({}).steps == 0);
}

TEST_CASE("a video that is too large for a page is linked, a smaller one is in it") {
  const tests::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "long video.mp4";
  std::string bytes;
  for (int k = 0; k < 7'000'001; ++k) bytes += char(std::int64_t(k) * k >> 3);
  REQUIRE(write_file(file, bytes));
  const Recording recording;
  const auto digest = digest_of(recording);
  for (const bool is_embedded : {true, false}) {
    std::string page;
    REQUIRE(write_report(*digest, {file, "long video.mp4", is_embedded ? bytes.size() : bytes.size() - 1},
                         [&](std::string_view text) { page += text; }));
    CHECK((page.find("src=\"long%20video.mp4\"") == std::string::npos) == is_embedded);
    CHECK((page.find("too large") == std::string::npos) == is_embedded);
    CHECK((page.find("src=\"data:video/mp4;base64,") != std::string::npos) == is_embedded);
    CHECK((page.size() > bytes.size() * 4 / 3) == is_embedded);
  }
  CHECK_FALSE(write_report(*digest, {folder.path / "none.mp4", "none.mp4"}, [](std::string_view) {}));
}
