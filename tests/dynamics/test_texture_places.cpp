// Where on whose texture a contact is, and how fast it sweeps there: uv goes as far as the sweep says.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "dynamics/world.h"
#include "intaglio/representation.h"
#include "tests/contact/curved_bases.h"

using namespace intaglio;
using namespace intaglio::dynamics;

namespace {

constexpr double pi = std::numbers::pi, step = 1.0 / 480;

std::shared_ptr<const surface::Surface> waves(const surface::Placement& placement, double depth) {
  return tests::made_surface(
      64, [](Vec2 uv) { return 0.5 + 0.5 * std::cos(16 * pi * uv.x()); },
      [](Vec2 uv) { return Vec3(0.1 * std::sin(16 * pi * uv.x()), 0, 1).normalized(); }, depth, placement);
}

std::shared_ptr<const surface::Surface> smooth_floor(double side) {
  return tests::made_surface(
      8, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); }, 0, tests::flat_placement(side));
}

Material material(double friction) {
  Material out;
  out.density = 600;
  out.friction = friction;
  out.restitution = out.rolling_resistance = 0;
  return out;
}

WorldOptions options(Representation representation) {
  WorldOptions out;
  out.representation = representation;
  return out;
}

// Follows one place from step to step; across seams uv is taken back by whole turns.
struct Track {
  Vec2 size;
  std::optional<Vec2> before{};
  double worst = 0, way = 0;  // m: the worst step's disagreement, the whole way
  int steps = 0;

  void add(const Vec2& uv, const Vec2& sweep) {
    if (before) {
      Vec2 moved = uv - *before;
      moved -= moved.array().round().matrix().eval();
      worst = std::max(worst, (moved.cwiseProduct(size) - sweep * step).norm());
      way += sweep.norm() * step;
      ++steps;
    }
    before = uv;
  }
};

// A ball with a texture round it, its poles to either side of its way along x.
ShapeBody skinned_ball(double radius, double depth) {
  const surface::TriangleMesh base = surface::make_sphere(radius, 96, 48);
  const surface::Placement measure(Vec3::Zero(), Quat::Identity(), 0.3, 0.2);
  ShapeBody ball;
  ball.shape = contact::Sphere{radius};
  ball.skin = tests::relief_on(base, waves(measure, depth));
  ball.material = material(1);
  ball.pose = {{0, radius + 1e-5, 0}, Quat(Eigen::AngleAxisd(0.5 * pi, Vec3::UnitX()))};
  ball.velocity = {0.3, 0, 0};
  ball.angular_velocity = {0, 0, -0.3 / radius};
  return ball;
}

}  // namespace

TEST_CASE("a ball that rolls sweeps over its own texture as far as its uv goes, with relief and without") {
  for (const Representation representation : {Representation::relief, Representation::normal}) {
    CAPTURE(int(representation));
    World world(smooth_floor(2), material(1), options(representation));
    const double radius = 0.05;
    const BodyId ball =
        world.add(skinned_ball(radius, representation == Representation::relief ? 1e-6 : 0.002));
    Track own{{0.3, 0.2}};
    for (int k = 0; k < 480; ++k) {
      world.step();
      bool is_first = true;
      for (const ContactEvent& event : world.events()) {
        REQUIRE(event.body == ball);
        REQUIRE(event.own);
        CHECK(event.own->texture == 0);
        CHECK(event.other == floor_body);
        CHECK_FALSE(event.other_pose);
        if (is_first) own.add(event.own->uv, event.own->sweep);
        is_first = false;
      }
    }
    MESSAGE("way " << own.way << " m in " << own.steps << " steps, worst step " << 1000 * own.worst << " mm");
    CHECK(own.steps > 400);
    // Once round is as far as the texture is long.
    CHECK(own.way == doctest::Approx(0.3 * 0.3 / (2 * pi * radius)).epsilon(0.07));
    // With relief the ball meets the edges between the triangles of its base: uv goes in leaps.
    if (representation == Representation::normal) CHECK(own.worst < 0.01 * 0.3 * step);
  }
}

TEST_CASE(
    "over a body that lies askew, uv and sweep are in that body's frame; a slide sweeps no own texture") {
  for (const Representation representation : {Representation::relief, Representation::normal}) {
    CAPTURE(int(representation));
    World world(smooth_floor(4), material(0), options(representation));
    const Vec3 half(0.3, 0.05, 0.3);
    ShapeBody table;
    table.shape = contact::Box{half};
    const surface::Placement top({0, half.y(), 0}, Quat::Identity(), 0.6, 0.6);
    const Quat upside_down(Eigen::AngleAxisd(pi, Vec3::UnitX()));
    table.faces = {waves({{0, -half.y(), 0}, upside_down, 0.6, 0.6}, 0), waves(top, 0)};
    table.material = material(0);
    table.motion = Motion::fixed;
    table.pose = {{0.2, 0.5, -0.1}, Quat(Eigen::AngleAxisd(0.7, Vec3::UnitY()))};
    const BodyId under = world.add(table);
    SphereBody ball;
    ball.radius = 0.02;
    ball.material = material(0);
    ball.position = table.pose.to_world({-0.2, half.y() + ball.radius + 1e-5, 0.1});
    ball.velocity = {0.2, 0, 0.1};
    world.add(ball);
    Track track{{0.6, 0.6}};
    for (int k = 0; k < 300; ++k) {
      world.step();
      bool is_first = true;
      for (const ContactEvent& event : world.events()) {
        REQUIRE(event.other == under);
        REQUIRE(event.sweep);
        REQUIRE(event.other_pose);
        CHECK(event.texture == 1);
        CHECK_FALSE(event.own);
        CHECK((event.other_pose->position - table.pose.position).norm() < 1e-6);
        const Vec3 local = table.pose.orientation.conjugate() * event.v_t;
        CHECK((*event.sweep - Vec2(local.x(), -local.z())).norm() < 1e-6);
        if (is_first) track.add(event.uv, *event.sweep);
        is_first = false;
      }
    }
    MESSAGE("way " << track.way << " m, worst step " << 1000 * track.worst << " mm");
    CHECK(track.way == doctest::Approx(std::hypot(0.2, 0.1) * 299 * step).epsilon(0.01));
    CHECK(track.worst < 0.01 * 0.22 * step);
  }
}

TEST_CASE("a block that slides on its own texture stands still on it") {
  World world(smooth_floor(4), material(0), options(Representation::normal));
  const Vec3 half(0.1, 0.05, 0.1);
  ShapeBody block;
  block.shape = contact::Box{half};
  const Quat upside_down(Eigen::AngleAxisd(pi, Vec3::UnitX()));
  block.faces = {waves({{0, -half.y(), 0}, upside_down, 0.2, 0.2}, 0.001)};
  block.material = material(0);
  block.pose.position = {0, half.y() + 1e-5, 0};
  block.velocity = {0.3, 0, 0};
  world.add(block);
  int told = 0;
  for (int k = 0; k < 200; ++k) {
    world.step();
    for (const ContactEvent& event : world.events()) {
      if (event.phase == ContactPhase::end) continue;
      REQUIRE(event.own);
      CHECK(event.own->sweep.norm() < 1e-3);
      CHECK(std::abs(event.v_t.x() - 0.3) < 1e-3);
      ++told;
    }
  }
  CHECK(told > 200);
}

TEST_CASE(
    "a ball on a plain body sweeps its own texture whoever was there first, and whether that body moves") {
  const double radius = 0.05;
  for (const Motion motion : {Motion::free, Motion::fixed}) {
    for (const bool ball_first : {true, false}) {
      CAPTURE(int(motion));
      CAPTURE(ball_first);
      World world(smooth_floor(4), material(1), options(Representation::normal));
      ShapeBody plank, ball = skinned_ball(radius, 0.002);
      const Vec3 half(0.6, 0.05, 0.2);
      plank.shape = contact::Box{half};
      plank.material = material(1);
      plank.motion = motion;
      plank.pose.position = {0.1, half.y() + 1e-5, 0};
      ball.pose.position.y() += 2 * half.y() + 1e-5;
      if (ball_first) world.add(ball);
      world.add(plank);
      if (!ball_first) world.add(ball);
      const BodyId round = ball_first ? 1 : 2;
      Track track{{0.3, 0.2}};
      for (int k = 0; k < 300; ++k) {
        world.step();
        bool is_first = true;
        for (const ContactEvent& event : world.events()) {
          if (event.body != round && event.other != round) continue;
          const bool is_own = event.body == round;
          if (is_own) {
            REQUIRE(event.own);
          } else {
            REQUIRE(event.sweep);
            CHECK(event.texture == 0);
          }
          if (is_first)
            track.add(is_own ? event.own->uv : event.uv, is_own ? event.own->sweep : *event.sweep);
          is_first = false;
        }
      }
      MESSAGE("way " << track.way << " m, worst step " << 1000 * track.worst << " mm");
      CHECK(track.way == doctest::Approx(0.3 * 300 * step * 0.3 / (2 * pi * radius)).epsilon(0.1));
      CHECK(track.worst < 0.02 * 0.3 * step);
    }
  }
}
