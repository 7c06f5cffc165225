#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "haptics/device.h"
#include "haptics/haptic_log.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

std::vector<ServoSample> recorded(const std::shared_ptr<const surface::Surface>& s,
                                  const ServoOptions& options) {
  SimulatedDevice device({}, {},
                         {{0, {-0.05, 0.02, 0}}, {0.5, {-0.05, -0.006, 0}}, {1.5, {0.05, -0.006, 0.01}}});
  PenServo servo(s, options);
  std::vector<ServoSample> samples;
  for (int k = 0; k < 1500; ++k) {
    samples.push_back(servo.tick(device));
    device.advance(1e-3);
  }
  return samples;
}

}  // namespace

TEST_CASE("a session written, read and replayed gives the same forces to the bit") {
  const auto s = tests::brick_surface(128, 0.16);
  const ServoOptions options;
  const auto samples = recorded(s, options);
  const std::string text = encode_log(1000, "brick", fingerprint(*s), samples);
  const auto log = decode_log(text, "a.csv");
  REQUIRE_MESSAGE(log, (log ? "" : log.error().message()));
  CHECK(log->rate == 1000);
  CHECK(log->texture == "brick");
  CHECK(log->surface == fingerprint(*s));
  REQUIRE(log->samples.size() == samples.size());
  CHECK(encode_log(log->rate, log->texture, log->surface, log->samples) == text);
  ReplayDevice device(log->samples);
  PenServo servo(s, options);
  double most = 0;
  while (!device.at_end()) most = std::max(most, servo.tick(device).force.norm());
  CHECK(device.largest_difference() == 0);
  CHECK(most > 0.5);
  // Another texture gives other forces.
  const auto other = tests::brick_surface(64, 0.16);
  CHECK(fingerprint(*other) != log->surface);
  ReplayDevice again(log->samples);
  PenServo elsewhere(other, options);
  while (!again.at_end()) elsewhere.tick(again);
  CHECK(again.largest_difference() > 0.01);
}

TEST_CASE("a log that is truncated, modified or something else is rejected with its line") {
  const auto s = tests::brick_surface(32, 0.16);
  auto samples = recorded(s, {});
  samples.resize(20);
  samples[3].force.x() = std::numeric_limits<double>::quiet_NaN();
  const std::string text = encode_log(1000, "brick\nwall", fingerprint(*s), samples);
  const auto whole = decode_log(text, "a.csv");
  REQUIRE(whole);
  CHECK(whole->texture == "brick wall");
  CHECK(std::isnan(whole->samples[3].force.x()));
  const auto refused = [](const std::string& bytes, const char* part) {
    const auto log = decode_log(bytes, "a.csv");
    REQUIRE_FALSE(log);
    const std::string message = log.error().message();
    CHECK(message.find("a.csv:") == 0);
    CHECK(message.find('\n') == std::string::npos);
    CHECK_MESSAGE(message.find(part) != std::string::npos, message);
  };
  for (std::size_t size = 0; size < text.size(); size += 7) refused(text.substr(0, size), "");
  refused("", "not a haptic log");
  refused("time,x\n", "not a haptic log");
  refused(text + "more\n", "after the end");
  std::string changed = text;
  changed[text.find("\n0.005,") + 12] ^= 1;
  refused(changed, "");
  std::string rate = text;
  rate.replace(text.find("rate 1000"), 9, "rate -100");
  refused(rate, "servo rate");
}
