#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "haptics/servo_loop.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

std::shared_ptr<const surface::Surface> flat_floor() {
  return tests::made_surface(
      8, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); });
}

// Held 2 mm deep; records the forces written. Read them when the loop has stopped.
class Held : public Device {
 public:
  Held() { forces_.reserve(1 << 16); }
  Vec3 read() override { return {0, -0.002, 0}; }
  void write(const GuardedForce& force) override {
    if (forces_.size() < forces_.capacity()) forces_.push_back({loop->now(), force.newtons().y()});
  }
  struct Written {
    double time, force;
  };
  const std::vector<Written>& forces() const { return forces_; }
  const ServoLoop* loop = nullptr;

 private:
  std::vector<Written> forces_;
};

// At rest in the middle of its workspace.
class NullDevice : public Device {
 public:
  Vec3 read() override { return Vec3::Zero(); }
  void write(const GuardedForce&) override {}
};

void pause(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

// Publishes every 5 ms for `seconds`, rearming after faults that a busy machine causes.
double beat(ServoLoop& loop, double seconds) {
  double last = 0;
  for (const double end = loop.now() + seconds; loop.now() < end; pause(0.005)) {
    if ((loop.latest().guard_status & guard_status::fault) != 0) loop.rearm();
    last = loop.now();
    loop.publish({});
  }
  return last;
}

}  // namespace

TEST_CASE("a scene that stalls releases the hand after 20 ms, within 50 ms, until rearmed") {
  Held device;
  ServoLoop loop(PenServo(flat_floor(), {}), device);
  device.loop = &loop;
  loop.publish({});
  loop.start();
  const double stalled = beat(loop, 1.2);
  pause(0.2);
  CHECK((loop.latest().guard_status & guard_status::fault) != 0);
  const double again = beat(loop, 1.0);
  loop.stop();
  MESSAGE(loop.priority());
  MESSAGE("wake-up p50 " << 1e6 * loop.wake_up().quantile(0.5) << " us, p99.9 "
                         << 1e6 * loop.wake_up().quantile(0.999) << " us; compute p50 "
                         << 1e6 * loop.compute().quantile(0.5) << " us, p99.9 "
                         << 1e6 * loop.compute().quantile(0.999) << " us; " << loop.skipped_ticks()
                         << " left out");
  double strongest = 0, at_last = 0, first_zero = 0;
  for (const auto& written : device.forces()) {
    if (written.time < stalled) strongest = std::max(strongest, written.force);
    // A tick may have begun before the 20 ms were over; every force written after 50 ms is zero.
    if (written.time > stalled + 0.05 && written.time < stalled + 0.15) at_last += std::abs(written.force);
    if (written.time > stalled && written.force == 0 && first_zero == 0) first_zero = written.time;
  }
  MESSAGE("zero " << 1e3 * (first_zero - stalled) << " ms after the last heartbeat");
  CHECK(strongest > 0.5);
  CHECK(at_last == 0);
  CHECK(first_zero > stalled);
  CHECK(again > stalled);
  CHECK(device.forces().back().force == 0);  // stop() releases the hand
  CHECK(std::any_of(device.forces().begin(), device.forces().end(),
                    [&](const auto& w) { return w.time > stalled + 0.2 && w.force > 0.3; }));
}

TEST_CASE("the loop reports every tick; a null device feels nothing") {
  NullDevice device;
  ServoOptions options;
  options.rate = 4000;
  options.workspace.origin = {0, 0.01, 0};
  ServoLoop loop(PenServo(flat_floor(), options), device);
  CHECK(loop.priority() == "servo thread not started");
  loop.start();
  ServoReport report;
  for (int k = 0; k < 400 && report.ticks < 100; ++k) {
    loop.publish({});
    pause(0.002);
    report = loop.latest();
  }
  loop.stop();
  CHECK(report.ticks >= 100);
  CHECK(report.tip == options.workspace.origin);
  CHECK(report.force == Vec3::Zero());
  CHECK_FALSE(report.touching);
  CHECK(loop.wake_up().count() == loop.compute().count());
  CHECK(loop.wake_up().count() >= report.ticks);
}

TEST_CASE("the quantiles of a histogram are within its buckets") {
  LatencyHistogram lateness;
  for (int k = 1; k <= 1000; ++k) lateness.add(k * 1e-6);
  CHECK(lateness.count() == 1000);
  for (const double q : {0.1, 0.5, 0.99}) {
    CHECK(lateness.quantile(q) >= q * 1e-3);
    CHECK(lateness.quantile(q) <= q * 1e-3 * 1.2);
  }
  CHECK(lateness.max() == doctest::Approx(1e-3));
}
