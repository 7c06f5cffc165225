#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "core/lock_free.h"
#include "sound/audio/devices.h"
#include "sound/live_sound.h"
#include "tests/count_allocations.h"
#include "tests/sound/scenes.h"
#include "tests/sound/test_clock_device.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::bodies;
using test::contact;
using test::step;

namespace {

// A source that counts.
struct Ramp : AudioSource {
  std::atomic<int> calls{0};
  float next = 0;
  void render(std::span<float> stereo) noexcept override {
    for (float& x : stereo) x = next++;
    ++calls;
  }
};

double peak_time(const std::vector<float>& stereo) {
  const auto louder = [](float a, float b) { return std::abs(a) < std::abs(b); };
  return double(std::max_element(stereo.begin(), stereo.end(), louder) - stereo.begin()) / 2 / 44'100;
}

// When anything is heard first.
double onset(const std::vector<float>& stereo) {
  const auto first = std::find_if(stereo.begin(), stereo.end(), [](float x) { return x != 0; });
  return double(first - stereo.begin()) / 2 / 44'100;
}

}  // namespace

TEST_CASE("a queue between two threads loses nothing, keeps the order, and refuses when full") {
  SpscQueue<int> queue(16);
  int refused = 0;
  std::thread producer([&] {
    for (int k = 0; k < 200'000; ++k) {
      while (!queue.push(k)) {
        ++refused;
        std::this_thread::yield();
      }
    }
  });
  bool in_order = true;
  for (int k = 0; k < 200'000;) {
    if (const int* const value = queue.front()) {
      in_order &= *value == k++;
      queue.pop();
    } else {
      std::this_thread::yield();
    }
  }
  producer.join();
  CHECK(in_order);
  CHECK(queue.front() == nullptr);
  for (int k = 0; k < 16; ++k) CHECK(queue.push(k));
  int more = 0;
  while (queue.push(0)) ++more;
  CHECK(more < 16);
}

TEST_CASE(
    "a test-clock device renders what it is told, in buffers of its size, only between start and stop") {
  TestClockDevice device(44'100, 100);
  Ramp ramp;
  device.turn(50);
  CHECK(device.played().empty());
  REQUIRE(device.start(ramp));
  CHECK_FALSE(device.start(ramp));
  device.turn(250);
  CHECK(ramp.calls == 3);
  CHECK(device.status().buffers == 3);
  CHECK(device.played().size() == 500);
  CHECK(device.played()[499] == 499);
  device.stop();
  device.turn(100);
  CHECK(device.played().size() == 500);
}

TEST_CASE("the null device plays by itself until it is stopped, and can be started again") {
  NullDevice device(48'000, 64);
  Ramp ramp;
  for (int round = 0; round < 2; ++round) {
    REQUIRE(device.start(ramp));
    CHECK_FALSE(device.start(ramp));
    while (ramp.calls < 5 * (round + 1)) std::this_thread::yield();
    device.stop();
    device.stop();
    const int calls = ramp.calls;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    CHECK(ramp.calls == calls);
    CHECK(device.status().buffers == std::uint64_t(calls));
  }
  CHECK(device.status().latency == doctest::Approx(64.0 / 48'000));
}

TEST_CASE("a device is chosen by name; without a sound card the default is the null device, and says so") {
  CHECK(open_audio_device({"null"}).value().device->name() == "null");
  const auto opened = open_audio_device();
  REQUIRE(opened);
  if (opened->device->name() == "null") CHECK(opened->note.find("null device") != std::string::npos);
  const auto missing = open_audio_device({"no such card"});
  REQUIRE_FALSE(missing);
  CHECK(missing.error().message().find("no audio device") != std::string::npos);
  CHECK_FALSE(open_audio_device({"null", 1}));
  CHECK_FALSE(open_audio_device({"null", 44'100, 1}));
}

TEST_CASE("an event is heard one delay after it happened, whatever the buffer") {
  for (const int buffer : {64, 100, 441}) {
    TestClockDevice device(44'100, buffer);
    LiveSound live({}, bodies(), {.delay = 0.01});
    REQUIRE(device.start(live));
    double began = 0;
    for (int k = 0; k < 480; ++k) {
      if (k == 100) live.push(contact(k, 0.05, 0, ContactPhase::begin));
      live.advance(k * step);
      if (k == 0) began = device.time();
      while (device.time() < began + k * step) device.turn(buffer);
    }
    // The blow is in the middle of its step.
    const double happened = began + 99.5 * step;
    CAPTURE(buffer);
    CHECK(onset(device.played()) - happened > 0);
    CHECK(onset(device.played()) - happened < 0.01 + 2 * step + double(buffer) / 44'100);
    const LiveStatus status = live.status();
    CHECK(status.events == 1);
    CHECK(status.dropped_events == 0);
    CHECK(status.synthesizer.late_events == 0);
    CHECK(peak_time(device.played()) >= onset(device.played()));
  }
}

TEST_CASE("events that come before physics has told its time wait for it") {
  TestClockDevice device(44'100, 64);
  LiveSound live({}, bodies(), {.delay = 0.01});
  REQUIRE(device.start(live));
  device.turn(4410);
  live.push(contact(1, 0.05, 0, ContactPhase::begin));
  device.turn(64);
  CHECK(live.status().events == 0);
  live.advance(step);
  device.turn(4410);
  CHECK(live.status().events == 1);
  CHECK(live.status().synthesizer.late_events == 0);
  CHECK(onset(device.played()) > 0.1);
}

TEST_CASE("a step's contacts are heard together: those of a step that is not over wait for the rest of it") {
  const auto played = [](bool split) {
    TestClockDevice device(44'100, 64);
    LiveSound live({}, bodies(), {.delay = 0.01});
    REQUIRE(device.start(live));
    for (int k = 1; k < 200; ++k) {
      live.push(contact(k, 0.002, 0.2, k == 1 ? ContactPhase::begin : ContactPhase::persist));
      if (split) device.turn(64);  // a buffer between the points of one step
      live.push(contact(k, 0.002, 0.2));
      live.advance(k * step);
      device.turn(split ? 28 : 92);
    }
    device.turn(4410);
    CHECK(live.status().events == 398);
    CHECK(live.status().synthesizer.late_events == 0);
    double energy = 0;
    for (const float x : device.played()) energy += double(x) * x;
    return energy;
  };
  CHECK(played(true) == doctest::Approx(played(false)).epsilon(0.05));
}

TEST_CASE("when physics stops for a while, what comes after is not late, and the delay comes back") {
  TestClockDevice device(44'100, 64);
  LiveSound live({}, bodies(), {.delay = 0.01});
  REQUIRE(device.start(live));
  const auto run = [&](int from, int to) {
    for (int k = from; k < to; ++k) {
      live.push(contact(k, 0.002, 0.2, k == from ? ContactPhase::begin : ContactPhase::persist));
      live.advance(k * step);
      device.turn(92);
    }
  };
  run(1, 200);
  CHECK(live.status().waits == 0);
  device.turn(44'100);  // a pause
  CHECK(live.status().waits > 600);
  run(200, 1000);
  CHECK(live.status().synthesizer.late_events == 0);
  CHECK(live.status().dropped_events == 0);
  CHECK(live.status().delay < 0.013);
}

TEST_CASE("a queue that overflows is counted; rendering live does not allocate") {
  LiveSound live({}, bodies(), {.queue = 64});
  for (int k = 1; k < 500; ++k) live.push(contact(k, 0.001));
  live.advance(1);
  std::vector<float> out(2048);
  const std::size_t before = allocations();
  for (int k = 0; k < 50; ++k) live.render(out);
  CHECK(allocations() == before);
  CHECK(live.status().dropped_events > 300);
  for (const float x : out) CHECK(std::abs(x) <= 1);
}

TEST_CASE("physics pushes while the device renders") {
  NullDevice device(44'100, 64);
  LiveSound live({}, bodies());
  REQUIRE(device.start(live));
  for (int k = 1; k < 100; ++k) {
    live.push(contact(k, 0.01, 0.1, k == 1 ? ContactPhase::begin : ContactPhase::persist));
    live.advance(k * step);
    live.set_listener({{0, 0.3, 0.01 * k}, Vec3::UnitX()});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  while (live.status().events < 99) std::this_thread::yield();
  device.stop();
  CHECK(live.status().dropped_events == 0);
  CHECK(live.status().mean_latency > 0);
}

TEST_CASE("ears: loudness falls with distance, sides are mirror images, energy does not depend on the side") {
  const Listener listener{{0, 0, 1}, Vec3::UnitX()};
  const EarGains ahead = ear_gains(listener, Vec3::Zero());
  CHECK(ahead.left == doctest::Approx(1));
  CHECK(ahead.right == doctest::Approx(1));
  CHECK(ear_gains(listener, {0, 0, -1}).left == doctest::Approx(0.5));
  for (const double x : {0.1, 0.7, 3.0, 100.0}) {
    const EarGains right = ear_gains(listener, {x, 0.2, 0}), left = ear_gains(listener, {-x, 0.2, 0});
    CHECK(right.right == doctest::Approx(left.left));
    CHECK(right.left == doctest::Approx(left.right));
    CHECK(right.right > right.left);
    const double distance = Vec3(x, 0.2, 1).norm();
    CHECK(0.5 * (right.left * right.left + right.right * right.right) ==
          doctest::Approx(1 / (distance * distance)).epsilon(1e-5));
  }
  // At the ear itself, and far away, all stays finite.
  CHECK(ear_gains(listener, listener.position).left == doctest::Approx(10));
  CHECK(ear_gains(listener, Vec3::Constant(1e300)).left == 0);
}

TEST_CASE("stereo does not depend on how it is cut, and a source ahead is the mono sound over distance") {
  const auto play = [](std::size_t block) {
    Synthesizer synthesizer({}, bodies());
    for (const ContactEvent& event : test::tumble()) synthesizer.push(event);
    synthesizer.set_listener({{0.1, 0.4, 0.6}, Vec3::UnitX()});
    std::vector<float> out(44'100);
    for (std::size_t done = 0; done < out.size(); done += 2 * block) {
      synthesizer.render_stereo(std::span(out).subspan(done, std::min(2 * block, out.size() - done)));
    }
    return out;
  };
  const std::vector<float> whole = play(22'050);
  for (const std::size_t block : {1, 16, 64, 441, 512}) CHECK(play(block) == whole);

  Synthesizer mono({}, bodies()), stereo({}, bodies());
  stereo.set_listener({{-0.2, 0, 2.05}, Vec3::UnitX()});
  for (Synthesizer* s : {&mono, &stereo}) s->push(contact(0, 0.05, 0, ContactPhase::begin));
  std::vector<float> one(4410), two(8820);
  mono.render(one);
  stereo.render_stereo(two);
  float worst = 0, peak = 0;
  for (std::size_t k = 64; k < one.size(); ++k) {
    worst = std::max(worst, std::abs(two[2 * k] - 0.5f * one[k]));
    peak = std::max(peak, std::abs(one[k]));
  }
  CHECK(worst < 0.02f * peak);
}
