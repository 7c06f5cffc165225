// The live session with all its threads. Times are generous: machines may be busy.
#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "intaglio/representation.h"
#include "scene/picture.h"
#include "scene/scene_reader.h"
#include "session/live_session.h"
#include "sound/audio/devices.h"
#include "tests/session/sessions.h"

using namespace intaglio;
using namespace intaglio::scene;
using namespace intaglio::session;
using tests::parsed;
using tests::wait_for;

namespace {

std::unique_ptr<LiveSession> live(const Scene& scene) {
  const auto surface = make_surface(scene);
  REQUIRE(surface);
  auto session = LiveSession::create(scene, *surface, {});
  REQUIRE(session);
  return std::move(*session);
}

const std::string dropped_ball =
    "[surface]\nrepresentation = \"flat\"\n[[ball]]\nradius = 0.05\nposition = [0.1, 0.4, 0.0]\n";

}  // namespace

TEST_CASE("a live ball falls and rests; paused it stays, steps one by one, and starts again when reset") {
  const auto session = live(parsed(dropped_ball));
  session->start(nullptr, nullptr);
  CHECK(wait_for(*session, [](const LiveState& s) { return s.time > 1.5 && s.mark_count > 0; }));
  CHECK(session->state().pose[0].position.y() == doctest::Approx(0.05).epsilon(0.05));
  Controls controls;
  controls.paused = true;
  session->set_controls(controls);
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  const std::uint64_t steps = session->state().steps;
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  CHECK(session->state().steps == steps);
  controls.single_steps = 3;
  session->set_controls(controls);
  CHECK(wait_for(*session, [&](const LiveState& s) { return s.steps == steps + 3; }));
  controls.resets = 1;
  session->set_controls(controls);
  CHECK(wait_for(*session, [](const LiveState& s) { return s.pose[0].position.y() > 0.39; }));
  session->stop();
}

TEST_CASE("a dragged ball hangs where it is pulled to, and a session that follows has it there") {
  const Scene scene = parsed(dropped_ball);
  const auto session = live(scene);
  session->start(nullptr, nullptr);
  Controls controls;
  controls.dragged = 1;
  controls.pull_to = {-0.1, 0.3, 0.2};
  session->set_controls(controls);
  CHECK(wait_for(*session, [&](const LiveState& s) {
    // Its weight stretches the spring by g / omega^2.
    return s.time > 0.5 && (s.pose[0].position - controls.pull_to).norm() < 0.03;
  }));
  session->stop();
  const Vec3 was = session->state().pose[0].position;
  const auto next = live(scene);
  next->follow(*session);
  next->start(nullptr, nullptr);
  controls = {};
  controls.paused = true;
  next->set_controls(controls);
  CHECK(wait_for(*next, [&](const LiveState& s) { return (s.pose[0].position - was).norm() < 0.1; }));
}

TEST_CASE("a session that follows does not repeat the resets and single steps of the one before") {
  const Scene scene = parsed(dropped_ball);
  const auto session = live(scene);
  session->start(nullptr, nullptr);
  CHECK(wait_for(*session, [](const LiveState& s) { return s.pose[0].position.y() < 0.3; }));
  Controls controls;
  controls.paused = true;
  session->set_controls(controls);
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  controls.resets = 1;
  controls.single_steps = 40;
  session->set_controls(controls);
  CHECK(wait_for(*session, [](const LiveState& s) { return s.pose[0].position.y() > 0.35; }));
  const std::uint64_t steps = session->state().steps;
  CHECK(wait_for(*session, [&](const LiveState& s) { return s.steps >= steps; }));
  session->stop();
  const Vec3 was = session->state().pose[0].position;
  CHECK(was.y() < 0.4);
  const auto next = live(scene);
  next->follow(*session);
  next->continue_counters(*session);
  next->set_controls(controls);  // the counters are the window's, and go on
  next->start(nullptr, nullptr);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(next->state().steps == 0);
  controls.single_steps = 41;
  next->set_controls(controls);
  CHECK(wait_for(*next, [](const LiveState& s) { return s.steps == 1; }));
  CHECK((next->state().pose[0].position - was).norm() < 0.02);
}

TEST_CASE("the mouse's pen comes down, touches, pushes back, and lets go") {
  const auto session = live(parsed("[surface]\nrepresentation = \"flat\"\n"));
  session->start(nullptr, nullptr);
  session->set_pen_target({0.1, -0.02, 0.1});
  CHECK(wait_for(*session, [](const LiveState& s) { return s.pen.touching && s.pen.force.y() > 0.05; }));
  CHECK(session->state().pen.proxy.y() >
        -0.01);  // it does not follow the tip to -0.02, even where ticks come late
  session->set_pen_target({0.1, 0.1, 0.1});
  CHECK(wait_for(*session, [](const LiveState& s) { return !s.pen.touching && s.pen.tip.y() > 0.05; }));
}

TEST_CASE("a hand that is given no touch feels nothing, and its pen touches all the same") {
  const auto session = live(parsed("[surface]\nrepresentation = \"flat\"\n[cues]\ntouch = false\n"));
  session->start(nullptr, nullptr);
  session->set_pen_target({0.1, -0.02, 0.1});
  CHECK(wait_for(*session, [](const LiveState& s) {
    return s.pen.touching && s.pen.force.y() > 0.05 && s.mark_count > 0 && s.pen.felt == Vec3::Zero();
  }));
  // Nothing holds the tip back; it is drawn on the surface.
  CHECK(wait_for(*session, [](const LiveState& s) { return s.pen.tip.y() < -0.018; }));
  CHECK(session->state().pen.proxy.y() > -0.01);
}

TEST_CASE("bodies are drawn as many steps late as their delay and the picture's say") {
  const auto pose_after = [](const std::string& cues, std::uint64_t steps) {
    const auto session = live(parsed(dropped_ball + cues));
    Controls controls;
    controls.paused = true;
    controls.single_steps = steps;
    session->set_controls(controls);
    session->start(nullptr, nullptr);
    REQUIRE(wait_for(*session, [&](const LiveState& s) { return s.steps == steps; }));
    session->stop();
    return session->state().pose[0].position;
  };
  // 48 steps of 1/480 s, and 12.
  const std::string late = "[cues.ball_motion]\ndelay = 0.1\n",
                    later = late + "[cues.picture]\ndelay = 0.025\n";
  CHECK(pose_after(late, 90) == pose_after("", 42));
  CHECK(pose_after(later, 90) == pose_after("", 30));
  CHECK(pose_after("", 42) != pose_after("", 41));
  CHECK(pose_after(late, 20) == pose_after("", 0));
}

TEST_CASE("sound starts when its models are ready, and an impact is heard") {
  const Scene scene = parsed(dropped_ball + "[sound]\nmodes = 4\n");
  VoiceBaker baker;
  AudioTap tap;
  sound::NullDevice device;
  REQUIRE(device.start(tap));
  {
    const auto session = live(scene);
    session->start(&tap, &baker);
    Controls controls;
    bool heard = false;
    std::vector<float> played;
    for (int k = 0; k < 24'000 && !heard; ++k) {  // two minutes: bakes are slow under sanitizers
      if (session->has_sound() && controls.resets == 0) controls.resets = 1;
      session->set_controls(controls);
      played.clear();
      tap.drain(played);
      for (const float sample : played) heard = heard || std::abs(sample) > 1e-4f;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    CHECK(session->has_sound());
    CHECK(heard);
  }
  device.stop();
}

TEST_CASE("every letter is a compound of boxes within its size; other text has no shape") {
  for (const char c : std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789")) {
    const auto shape = letter_shape(std::string(1, c), {0.10, 0.02, 0.14});
    REQUIRE(shape);
    const auto& children = *std::get<contact::Compound>(*shape).children;
    double volume = 0;
    for (const contact::CompoundChild& child : children) {
      const Vec3 half = std::get<contact::Box>(child.shape).half;
      volume += 8 * half.prod();
      CHECK(((child.pose.position.cwiseAbs() + half - Vec3(0.05, 0.01, 0.07)).array() < 1e-12).all());
    }
    CHECK(volume > 0.2 * 0.10 * 0.02 * 0.14);
    CHECK(volume < 0.8 * 0.10 * 0.02 * 0.14);
    CHECK(shape_mesh(*shape).indices.size() == 36 * children.size());
  }
  CHECK_FALSE(letter_shape("a", {1, 1, 1}));
  CHECK_FALSE(letter_shape("AB", {1, 1, 1}));
}

TEST_CASE("bodies, grounds, flippers and bumpers read from a scene; the floor's frame is turned with it") {
  const Scene scene = parsed(R"([surface]
rotation = [90, 0, 0]
[[ground]]
size = [0.5, 0.4]
position = [0, 1, 0]
[[ball]]
frame = "floor"
position = [0.1, 0.2, 0.0]
[[body]]
shape = "cylinder"
radius = 0.03
height = 0.2
motion = "fixed"
kick = 2
[[body]]
key = "right"
sweep = -40
)");
  CHECK(scene.grounds.size() == 1);
  CHECK((scene.balls[0].position - Vec3(0.1, 0.0, 0.2)).norm() < 1e-12);
  CHECK(scene.bodies[0].kick == 2);
  CHECK(scene.bodies[0].body.motion == dynamics::Motion::fixed);
  REQUIRE(scene.bodies[1].flipper);
  CHECK(scene.bodies[1].flipper->key == 1);
  CHECK(scene.bodies[1].body.motion == dynamics::Motion::driven);
  CHECK_FALSE(parse_scene("[[body]]\nshape = \"letter\"\nletter = \"?\"\n", "s"));
  CHECK_FALSE(parse_scene("[[body]]\nsize = [1, -1, 1]\n", "s"));
}

TEST_CASE("flippers turn while their key is held, and a ball that falls below starts again") {
  const Scene scene = parsed(R"([surface]
representation = "flat"
[physics]
respawn_below = -0.5
[[ball]]
radius = 0.02
position = [3, 0.1, 0]
[[body]]
size = [0.1, 0.02, 0.02]
position = [0, 0.1, 0]
key = "left"
pivot = [-0.05, 0, 0]
sweep = 60
)");
  const auto surface = make_surface(scene);
  REQUIRE(surface);
  SceneWorld world(scene, *surface, Representation::flat);
  double lowest = 1, highest_later = -1;
  for (int k = 0; k < 480; ++k) {
    world.step(left_key);
    const double y = world.pose(0).position.y();
    lowest = std::min(lowest, y);
    if (lowest < -0.3) highest_later = std::max(highest_later, y);
  }
  CHECK(lowest > -0.6);
  CHECK(highest_later > 0.05);
  const Pose struck = world.pose(1);
  CHECK(Quat(struck.orientation).angularDistance(Quat::Identity()) ==
        doctest::Approx(3.14159265 / 3).epsilon(1e-3));
  CHECK((struck.to_world({-0.05, 0, 0}) - Vec3(-0.05, 0.1, 0)).norm() < 1e-5);
  for (int k = 0; k < 60; ++k) world.step(0);
  CHECK(world.pose(1).orientation.angularDistance(Quat::Identity()) < 1e-3);
}
