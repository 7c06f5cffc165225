#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "intaglio/representation.h"
#include "session/simulation.h"
#include "tests/session/sessions.h"

using namespace intaglio;
using namespace intaglio::scene;
using namespace intaglio::session;
using tests::parsed;

namespace {

Recording recording_of(const std::string& text) {
  Scene scene = parsed(text);
  scene.sound.modes = 30;
  auto surface = make_surface(scene);
  REQUIRE(surface);
  auto simulation = Simulation::create(scene, *surface, tests::cached_models());
  REQUIRE(simulation);
  Recording recording;
  (*simulation)->add_observer(recording);
  (*simulation)->advance_to_frame(3);
  (*simulation)->finish();
  static_cast<Run&>(recording) = (*simulation)->run();
  return recording;
}

double rms(const std::vector<float>& audio, double from, double to) {
  double sum = 0;
  const auto a = std::size_t(from * 44100);
  const auto b = std::min(audio.size(), std::size_t(to * 44100));
  for (std::size_t k = a; k < b; ++k) sum += double(audio[k]) * double(audio[k]);
  return std::sqrt(sum / double(b - a));
}

const std::string falling_ball = "duration = 1.5\n[[ball]]\nradius = 0.04\nposition = [0.0, 0.2, 0.0]\n";

}  // namespace

TEST_CASE("the same scene gives the same events and the same sound, whatever frames are looked at") {
  const Recording a = recording_of(falling_ball);
  const Recording b = recording_of(falling_ball + "[video]\nfps = 25\n");
  CHECK(a.event_hash == b.event_hash);
  CHECK(a.audio_hash == b.audio_hash);
  CHECK(a.events.size() > 0);
}

TEST_CASE("a dropped ball is silent until it lands, loud when it lands, and never clips") {
  const Recording recording = recording_of(falling_ball);
  REQUIRE(!recording.events.empty());
  const double landed = recording.events.front().time;
  // Free fall from 0.2 m to the relief, whose top lies up to some millimetres below the base plane.
  CHECK(landed == doctest::Approx(std::sqrt(2 * 0.16 / 9.81)).epsilon(0.05));
  CHECK(rms(recording.audio, 0, landed - 0.005) == 0);
  CHECK(rms(recording.audio, landed, landed + 0.05) > 1e-4);
  for (const float sample : recording.audio) CHECK(std::abs(sample) <= 1);
}

TEST_CASE("a scene without contacts is silent") {
  const Recording recording = recording_of("duration = 0.5\n");
  CHECK(recording.events.empty());
  CHECK(std::all_of(recording.audio.begin(), recording.audio.end(), [](float s) { return s == 0; }));
}

TEST_CASE("every representation runs, and all senses get the same texture") {
  for (const char* representation : {"flat", "normal", "relief"}) {
    const Recording recording = recording_of(
        "duration = 1.2\n[surface]\nrepresentation = \"" + std::string(representation) +
        "\"\n[pen]\npath = [[0, -0.02, 0.01, 0], [0.3, -0.02, -0.01, 0], [1.2, 0.06, -0.01, 0.02]]\n");
    CHECK(recording.servo.size() > 1000);
    CHECK(std::any_of(recording.servo.begin(), recording.servo.end(),
                      [](const auto& s) { return s.touching; }));
    for (const ContactEvent& event : recording.events) {
      // The normal that is felt is the map's at that place.
      const Vec3 map = recording.surface->world_normal(event.uv);
      if (event.phase != ContactPhase::end && recording.representation != Representation::flat)
        CHECK((event.n_s - map).norm() < 1e-9);
    }
    CHECK(rms(recording.audio, 0.3, 1.2) > 0);
  }
}

TEST_CASE("a pen that sweeps into a ball pushes it, feels it, and no momentum is lost") {
  const Recording recording = recording_of(
      "duration = 2.5\n[surface]\nrepresentation = \"flat\"\n[[ball]]\nradius = 0.04\nmass = 0.05\nposition = [0.0, "
      "0.04, 0.0]\n[pen]\ndirection = [0, 1, 0]\npath = [[0, -0.06, 0.03, 0], [1, -0.06, 0.03, 0], [1.8, 0.0, "
      "0.03, 0], [2.5, 0.0, 0.03, 0]]\n");
  REQUIRE(recording.tracks.size() == 1);
  CHECK(recording.tracks[0].back().x() > 0.03);
  CHECK(std::any_of(recording.servo.begin(), recording.servo.end(),
                    [](const auto& s) { return s.touching_ball && s.force.x() < -0.02; }));
  CHECK(recording.momentum_residual < 1e-5);
}

TEST_CASE("the paper's plane can be chosen for the pen") {
  const std::string text =
      "duration = 1\n[pen]\npath = [[0, 0, 0.01, 0], [0.3, 0, -0.01, 0], [1, 0.05, -0.01, 0.02]]\n";
  const Recording ours = recording_of(text), plane = recording_of(text + "method = \"plane\"\n");
  double difference = 0;
  for (std::size_t k = 0; k < ours.servo.size(); ++k)
    difference += (ours.servo[k].force - plane.servo[k].force).norm();
  CHECK(difference > 1);
}
