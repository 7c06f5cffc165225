// Whether the servo loop keeps its deadlines while everything else runs: bench_session [--json] [SECONDS], 6
// by default for each rate.
//
// In one thread the brick scene is simulated, heard and drawn (`intaglio render`, with threads of its own for
// the pictures and the encoder); in another a servo loop runs in real time at 1, 4 and 8 kHz, with a
// simulated hand that drags over the brick; the main thread is the scene, which publishes a snapshot 480
// times a second. How late ticks woke up is the machine's doing, how long they took to compute is ours: two
// histograms, wall time.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "haptics/servo_loop.h"
#include "report/render_job.h"
#include "session/simulation.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

constexpr const char* scene_text =
    "duration = 60\n[surface]\ndepth = 0.02\n[[ball]]\nradius = 0.04\nposition = [-0.42, 0.06, 0.36]\nvelocity = [1.5, "
    "0, -0.9]\n[[ball]]\nradius = 0.05\nposition = [0.3, 0.4, 0.2]\n[pen]\nworkspace_scale = 5\npath = [[0, -0.3, 0.05, "
    "0], [2, -0.3, -0.03, 0], [30, 0.3, -0.03, 0.3], [60, -0.3, -0.03, -0.3]]\n";

// A simulated hand in real time: each tick's force moves it for a tick.
class RealTimeHand : public SimulatedDevice {
 public:
  RealTimeHand(double rate, std::vector<Waypoint> path)
      : SimulatedDevice({2.3e-5, {0.16, 0.12, 0.12}, 7.9, rate}, {}, std::move(path)), period_(1 / rate) {}
  void write(const GuardedForce& force) override {
    SimulatedDevice::write(force);
    advance(period_);
  }

 private:
  double period_;
};

// Simulates, sounds and draws until told to stop.
class Load {
 public:
  explicit Load(const scene::Scene& scene)
      : thread_([this, scene] {
          while (!stop_) {
            if (!report::render(scene, {folder_.path / "load.mp4", 2, true, &stop_}) && !stop_)
              failed_ = true;
            if (failed_) return;
          }
        }) {}
  ~Load() {
    stop_ = true;
    thread_.join();
  }
  bool failed() const { return failed_; }

 private:
  tests::TemporaryFolder folder_;
  std::atomic<bool> stop_{false}, failed_{false};
  std::thread thread_;
};

struct Row {
  double rate;
  std::string what;
  const LatencyHistogram* times;
};

void print(const Row& row, bool json, bool last) {
  const auto us = [&](double q) { return 1e6 * row.times->quantile(q); };
  if (json) {
    fmt::print(
        "  {{\"rate\": {}, \"what\": \"{}\", \"ticks\": {}, \"p50_us\": {:.4g}, \"p99_us\": {:.4g}, \"p999_us\": {:.4g}, "
        "\"most_us\": {:.4g}}}{}\n",
        row.rate, row.what, row.times->count(), us(0.5), us(0.99), us(0.999), 1e6 * row.times->max(),
        last ? "" : ",");
  } else {
    fmt::print("{:>6} {:<16}{:>9}{:>10.1f}{:>10.1f}{:>10.1f}{:>11.1f}\n", row.rate, row.what,
               row.times->count(), us(0.5), us(0.99), us(0.999), 1e6 * row.times->max());
  }
}

void measure(const std::shared_ptr<const surface::Surface>& surface, double rate, double seconds, bool json,
             bool last) {
  ServoOptions options;
  options.rate = rate;
  options.workspace.scale = 5;
  RealTimeHand hand(rate,
                    {{0, {-0.06, 0.02, 0}}, {1, {-0.06, -0.006, 0}}, {2 + seconds, {0.06, -0.006, 0.02}}});
  ServoLoop loop(PenServo(surface, options), hand);
  loop.publish({});
  loop.start();
  int faults = 0;
  const double end = loop.now() + seconds;
  while (loop.now() < end) {
    if ((loop.latest().guard_status & guard_status::fault) != 0) {
      ++faults;
      loop.rearm();
    }
    loop.publish({});
    std::this_thread::sleep_for(std::chrono::microseconds(2083));
  }
  loop.stop();
  print({rate, "wake-up", &loop.wake_up()}, json, false);
  print({rate, "compute", &loop.compute()}, json, last);
  if (!json)
    fmt::print("       {}; {} ticks left out, {} faults seen\n", loop.priority(), loop.skipped_ticks(),
               faults);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  bool json = false;
  double seconds = 6;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--json") == 0) {
      json = true;
    } else if (seconds = std::atof(argv[k]); !(seconds >= 0.5 && seconds <= 3600)) {
      fmt::print(stderr, "bench_session: '{}' is neither --json nor seconds in 0.5..3600\n", argv[k]);
      return 2;
    }
  }
  const auto scene = scene::parse_scene(scene_text, "bench");
  const auto surface = scene ? scene::make_surface(*scene) : tl::unexpected(scene.error());
  if (!surface) {
    fmt::print(stderr, "bench_session: {}\n", surface.error().message());
    return 1;
  }
  Load load(*scene);
  std::this_thread::sleep_for(std::chrono::seconds(10));  // until the modal models are made
  if (json) fmt::print("[\n");
  if (!json)
    fmt::print("{:>6} {:<16}{:>9}{:>10}{:>10}{:>10}{:>11}  us\n", "rate", "", "ticks", "p50", "p99", "p99.9",
               "most");
  for (const double rate : {1000.0, 4000.0, 8000.0})
    measure(surface->surface, rate, seconds, json, rate == 8000.0);
  if (json) fmt::print("]\n");
  if (load.failed()) {
    fmt::print(stderr, "bench_session: the load could not run (is ffmpeg there?)\n");
    return 1;
  }
  return 0;
}
