// The one loop of offline and live sessions, and the pen's link to it.
#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "intaglio/representation.h"
#include "intaglio/vec.h"
#include "session/live_session.h"
#include "session/scene_loop.h"
#include "session/simulation.h"
#include "tests/session/sessions.h"

using namespace intaglio;
using namespace intaglio::scene;
using namespace intaglio::session;
using tests::parsed;
using tests::wait_for;

namespace {

SceneSurface surface_of(const Scene& scene) {
  auto surface = make_surface(scene);
  REQUIRE_MESSAGE(surface, (surface ? "" : surface.error().message()));
  return std::move(*surface);
}

// A floor whose normal map leans by a tenth everywhere.
SceneSurface leaning(const Scene& scene) {
  SceneSurface out = surface_of(scene);
  surface::Texels texels;
  texels.width = texels.height = 64;
  texels.normal.assign(64 * 64, Vec3(-0.1, 0, 1).normalized());
  out.surface = std::make_shared<const surface::Surface>(std::move(texels), out.surface->placement(), 0.01,
                                                         surface::Edge::wrap);
  return out;
}

const std::string normal_map =
    "[surface]\nrepresentation = \"normal\"\n[[ball]]\nradius = 0.05\nposition = [0.1, 0.05, 0.0]\nvelocity = "
    "[0.4, 0, 0.3]\n";

// A pen's report as a servo on that solid would give it.
haptics::ServoReport touching_at(const Vec3& proxy) {
  haptics::ServoReport report;
  report.proxy = proxy;
  report.tip = proxy;
  report.touching = true;
  report.force = {0, 1, 0};
  report.velocity = {0.1, 0, 0.02};
  return report;
}

// A device held still, whatever it pushes back with.
struct HeldDevice : haptics::Device {
  explicit HeldDevice(const Vec3& at) : position(at) {}
  Vec3 read() override { return position; }
  void write(const haptics::GuardedForce&) override {}

  Vec3 position;
};

Recording simulated(const Scene& scene, const SceneSurface& surface) {
  auto recording = play(scene, surface, tests::cached_models());
  REQUIRE_MESSAGE(recording, (recording ? "" : recording.error().message()));
  return std::move(*recording);
}

// Paused from the start, so that it takes exactly as many steps as are asked for.
LiveState after_steps(LiveSession& session, std::uint64_t steps) {
  Controls controls;
  controls.paused = true;
  controls.single_steps = steps;
  session.set_controls(controls);
  session.start(nullptr, nullptr);
  CHECK(wait_for(session, [&](const LiveState& s) { return s.steps == steps; }));
  session.stop();
  return session.state();
}

// The newest contacts that go on, of one body or of all.
std::vector<ContactMark> marks_of(const LiveState& state) {
  std::vector<ContactMark> out;
  for (std::uint64_t k = state.mark_count - std::min<std::uint64_t>(state.mark_count, max_marks);
       k < state.mark_count; ++k)
    out.push_back(state.marks[k % max_marks]);
  return out;
}

}  // namespace

TEST_CASE("offline and live give the same contacts for the same steps of a scene") {
  const Scene scene = parsed(R"(duration = 0.5
[sound]
modes = 4
[[ground]]
size = [0.4, 0.4]
position = [0.3, 0.05, 0]
rotation = [0, 0, 8]
[[ball]]
radius = 0.04
position = [0.3, 0.12, 0.02]
[[ball]]
radius = 0.03
position = [-0.2, 0.05, 0.1]
velocity = [0.3, 0, 0]
[[body]]
size = [0.06, 0.04, 0.05]
position = [-0.2, 0.06, -0.2]
)");
  const SceneSurface surface = surface_of(scene);
  std::vector<ContactEvent> offline;
  for (const ContactEvent& event : simulated(scene, surface).events)
    if (event.phase != ContactPhase::end) offline.push_back(event);
  const auto session = LiveSession::create(scene, surface, {});
  REQUIRE(session);
  const LiveState state = after_steps(**session, std::uint64_t(scene.duration * scene.physics.rate));
  REQUIRE(state.mark_count == offline.size());
  const auto marks = marks_of(state);
  REQUIRE(marks.size() == max_marks);
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const ContactEvent& event = offline[offline.size() - marks.size() + k];
    CHECK(marks[k].time == event.time);
    CHECK(marks[k].body == event.body);
    CHECK(marks[k].other == event.other);
    CHECK(marks[k].begins == (event.phase == ContactPhase::begin));
    CHECK(marks[k].point == event.point);
    CHECK(marks[k].n_s == event.n_s);
    CHECK(marks[k].impulse == event.impulse);
    CHECK(marks[k].uv == event.uv);
  }
}

TEST_CASE("the pen meets a ground above the floor, offline and live, and rings it") {
  const Scene scene = parsed(R"(duration = 0.8
[sound]
modes = 4
[[ground]]
texture = "pebbles"
depth = 0.005
size = [0.4, 0.4]
position = [0.1, 0.10, 0.05]
rotation = [0, 0, -10]
[pen]
workspace_origin = [0.1, 0.1, 0.05]
path = [[0, 0.04, 0.12, 0.05], [0.1, 0.05, 0.102, 0.05], [0.8, 0.16, 0.082, 0.05]]
)");
  // The path begins above the ground and stays in the device's workspace of 16 x 12 x 12 cm.
  const SceneSurface surface = surface_of(scene);
  const Recording recording = simulated(scene, surface);
  std::vector<ContactEvent> felt;
  for (const ContactEvent& event : recording.events)
    if (event.body == recording.pen && event.phase != ContactPhase::end) felt.push_back(event);
  REQUIRE(felt.size() > 300);
  const surface::Surface& ground = *surface.grounds[0].surface;
  for (const ContactEvent& event : felt) {
    CHECK(event.other == first_surface_body);
    CHECK((event.n_g - ground.placement().n()).norm() < 1e-12);
    CHECK((event.n_s - ground.world_normal(event.uv)).norm() < 1e-12);
    const Vec3 local = ground.placement().to_local(event.point);
    CHECK((event.uv - ground.placement().uv(local)).norm() < 1e-12);
    CHECK(local.z() > -ground.max_depth() - 0.005);  // it does not pass through
  }
  double loudest = 0;
  for (const float sample : recording.audio) loudest = std::max(loudest, std::abs(double(sample)));
  CHECK(loudest > 1e-6);

  HeldDevice device(scene.pen->workspace.to_device(felt.back().point - 0.01 * ground.placement().n()));
  const auto session = LiveSession::create(scene, surface, {}, &device);
  REQUIRE(session);
  (*session)->start(nullptr, nullptr);
  CHECK(wait_for(**session, [](const LiveState& s) { return s.pen.touching && s.mark_count > 100; }));
  (*session)->stop();
  for (const ContactMark& mark : marks_of((*session)->state())) {
    CHECK(mark.body == recording.pen);
    CHECK(mark.other == first_surface_body);
    CHECK((mark.n_g - ground.placement().n()).norm() < 1e-12);
    CHECK((mark.n_s - ground.world_normal(mark.uv)).norm() < 1e-12);
    CHECK((mark.point - felt.back().point).norm() < 0.02);
  }
}

TEST_CASE("a pen that crosses from one ground to another ends one contact and begins the other") {
  const Scene scene = parsed(R"([surface]
representation = "flat"
[[ground]]
size = [0.4, 0.4]
position = [0.4, 0.001, 0]
[[ground]]
base = { shape = "sphere", radius = 0.1 }
depth = 0.002
thickness = 0.02
position = [0.9, 0, 0]
[pen]
path = [[0, 0, 0.1, 0]]
)");
  std::vector<ContactEvent> events;
  SceneLoop loop(scene, surface_of(scene), Representation::flat, Representation::flat,
                 [&](const ContactEvent& event) { events.push_back(event); });
  const auto touch = [&](const std::optional<Vec3>& proxy, double time) {
    haptics::ServoReport report = proxy ? touching_at(*proxy) : haptics::ServoReport();
    loop.emit_pen(report, time, 1e-3);
  };
  double time = 0;
  for (double x = 0; x < 0.5; x += 0.01) touch(Vec3(x, x < 0.2 ? -0.001 : 0, 0), time += 1e-3);
  touch(std::nullopt, time += 1e-3);
  const Vec3 up = Vec3(1, 1, 0.2).normalized();
  for (int k = 0; k < 5; ++k) touch(Vec3(0.9, 0, 0) + 0.099 * up, time += 1e-3);
  touch(std::nullopt, time += 1e-3);

  std::map<BodyId, int> begun, ended;
  std::map<BodyId, bool> on;
  for (const ContactEvent& event : events) {
    CHECK(event.body == loop.world().pen());
    CHECK((event.phase == ContactPhase::begin) == !on[event.other]);
    on[event.other] = event.phase != ContactPhase::end;
    begun[event.other] += event.phase == ContactPhase::begin;
    ended[event.other] += event.phase == ContactPhase::end;
    int touched = 0;
    for (const auto& [ground, is_on] : on) touched += is_on;
    CHECK(touched <= 1);
  }
  for (const BodyId ground : {floor_body, first_surface_body, first_surface_body + 1}) {
    CHECK(begun[ground] == 1);
    CHECK(ended[ground] == 1);
  }
  // Its impulses are the pen's, once.
  Vec3 sum = Vec3::Zero();
  for (const ContactEvent& event : events) sum += event.impulse;
  CHECK(sum.y() == doctest::Approx(1e-3 * 55));
  // On a curved ground the event says which way its texture passes, and how fast.
  const ContactEvent& last = events[events.size() - 2];
  REQUIRE(last.other == first_surface_body + 1);
  CHECK((last.n_g - up).norm() < 0.05);
  REQUIRE(last.sweep);
  CHECK(std::abs(last.sweep->norm() / last.v_t.norm() - 1) < 0.4);
}

TEST_CASE("a world that follows another keeps its velocities, also over a normal map that leans") {
  const Scene scene = parsed(normal_map);
  const SceneSurface surface = leaning(scene);
  SceneWorld first(scene, surface, Representation::normal), second(scene, surface, Representation::normal),
      flat(scene, surface, Representation::flat);
  for (int k = 0; k < 100; ++k) first.step();
  second.follow(first);
  CHECK((second.world().velocity(1) - first.world().velocity(1)).norm() < 1e-6);
  CHECK((second.world().drawn_velocity(1) - first.world().drawn_velocity(1)).norm() < 1e-6);
  CHECK((second.pose(0).position - first.pose(0).position).norm() < 1e-5);
  // The drawn ball rolls on the flat floor; in a world without the map that is the only one.
  flat.follow(first);
  // It climbs the map's slope of a tenth, once, with what friction and the climb have left of 0.4 m/s:
  // 5/7 (0.4 - g sin(slope) t) when it has come to roll.
  const Vec3 climbing = first.world().velocity(1);
  const double sine = 0.1 / std::sqrt(1.01), left = 5.0 / 7 * (0.4 - 9.81 * sine * first.world().time());
  CHECK(std::abs(climbing.x() - left) < 0.1 * left);
  CHECK(std::abs(climbing.y() - 0.1 * climbing.x()) < 0.005 * climbing.x());
  CHECK(std::abs(flat.world().velocity(1).y()) < 0.005);
  flat.follow(second);
  second.follow(flat);
  CHECK((second.world().velocity(1) - first.world().velocity(1)).norm() < 1e-6);
}

TEST_CASE("the pen is given balls where they are drawn, at the speed at which they are seen to move") {
  const Scene scene = parsed(normal_map + "[pen]\npath = [[0, 0, 0.3, 0]]\n");
  SceneLoop loop(scene, leaning(scene), Representation::normal, Representation::normal, {});
  for (int k = 0; k < 100; ++k) loop.step(nullptr);
  const dynamics::World& world = loop.world().world();
  REQUIRE((world.pose(1).position - world.drawn_pose(1).position).norm() > 0.005);
  const haptics::SceneSnapshot seen = loop.snapshot(), slow = loop.snapshot(0.25), paused = loop.snapshot(0);
  REQUIRE(seen.ball_count == 1);
  CHECK(seen.balls[0].position == world.drawn_pose(1).position);
  CHECK(seen.balls[0].radius == 0.05);
  const Vec3 before = world.drawn_pose(1).position;
  loop.step(nullptr);
  const Vec3 moved = (world.drawn_pose(1).position - before) * double(scene.physics.rate);
  CHECK((seen.balls[0].velocity - moved).norm() < 0.01);
  CHECK((slow.balls[0].velocity - 0.25 * seen.balls[0].velocity).norm() < 1e-12);
  CHECK(paused.balls[0].velocity == Vec3::Zero());
}

TEST_CASE("a push acts at the point where it is felt: through the centre as drawn it turns nothing") {
  const Scene scene = parsed(normal_map);
  SceneLoop loop(scene, leaning(scene), Representation::normal, Representation::normal, {});
  for (int k = 0; k < 100; ++k) loop.step(nullptr);
  dynamics::World& world = loop.world().world();
  REQUIRE((world.pose(1).position - world.drawn_pose(1).position).norm() > 0.005);
  const Vec3 spin = world.angular_velocity(1), velocity = world.velocity(1);
  world.push(1, {0.1, 0, 0.2}, world.drawn_pose(1).position);
  CHECK((world.angular_velocity(1) - spin).norm() < 1e-4);
  CHECK((world.velocity(1) - velocity).norm() > 0.01);
  // At the drawn top it turns the ball about its own centre; the simulated ball leans by the map's mean
  // slope.
  const double mass = scene.balls[0].mass();
  world.push(1, {0.1, 0, 0}, world.drawn_pose(1).position + Vec3(0, 0.05, 0));
  const double expected = 0.1 * 0.05 / (0.4 * mass * 0.05 * 0.05);
  const Vec3 turned = world.angular_velocity(1) - spin;
  CHECK(turned.norm() == doctest::Approx(expected).epsilon(0.01));
}
