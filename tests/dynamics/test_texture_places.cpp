// The place of a contact on a texture, and how fast it sweeps over it: uv advances by the integral of sweep.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "dynamics/world.h"
#include "intaglio/representation.h"
#include "tests/dynamics/worlds.h"
#include "tests/mesh/curved_bases.h"

using namespace intaglio;
using namespace intaglio::dynamics;
using std::numbers::pi;
using tests::light_material;
using tests::options_for;

namespace {

constexpr double world_step = 1.0 / 480;

std::shared_ptr<const surface::Surface> waves(const surface::Placement& placement, double depth) {
  return tests::made_surface(
      64, [](Vec2 uv) { return 0.5 + 0.5 * std::cos(16 * pi * uv.x()); },
      [](Vec2 uv) { return Vec3(0.1 * std::sin(16 * pi * uv.x()), 0, 1).normalized(); }, depth, placement);
}

std::shared_ptr<const surface::Surface> smooth_floor(double side) {
  return tests::made_surface(
      8, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); }, 0, tests::flat_placement(side));
}

// Follows one contact from step to step; across seams uv is unwrapped.
struct Track {
  Vec2 size;
  std::optional<Vec2> before{};
  double worst = 0, way = 0;  // m: the largest error of a step, the distance covered
  int steps = 0;

  void add(const Vec2& uv, const Vec2& sweep) {
    if (before) {
      Vec2 moved = uv - *before;
      moved -= moved.array().round().matrix().eval();
      worst = std::max(worst, (moved.cwiseProduct(size) - sweep * world_step).norm());
      way += sweep.norm() * world_step;
      ++steps;
    }
    before = uv;
  }
};

// A ball with a texture round it, its poles to either side of its path along x.
ShapeBody skinned_ball(double radius, double depth) {
  const surface::TriangleMesh base = surface::make_sphere(radius, 96, 48);
  const surface::Placement measure(Vec3::Zero(), Quat::Identity(), 0.3, 0.2);
  ShapeBody ball;
  ball.shape = contact::Sphere{radius};
  ball.skin = tests::relief_on(base, waves(measure, depth));
  ball.material = light_material(1);
  ball.pose = {{0, radius + 1e-5, 0}, Quat(Eigen::AngleAxisd(0.5 * pi, Vec3::UnitX()))};
  ball.velocity = {0.3, 0, 0};
  ball.angular_velocity = {0, 0, -0.3 / radius};
  return ball;
}

}  // namespace

TEST_CASE("a rolling ball sweeps over its own texture as far as its uv advances, with relief and without") {
  for (const Representation representation : {Representation::relief, Representation::normal}) {
    CAPTURE(int(representation));
    World world(smooth_floor(2), light_material(1), options_for(representation));
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
    // One turn covers the length of the texture.
    CHECK(own.way == doctest::Approx(0.3 * 0.3 / (2 * pi * radius)).epsilon(0.07));
    // With relief the ball touches at the edges between the triangles of its base, so uv jumps.
    if (representation == Representation::normal) CHECK(own.worst < 0.01 * 0.3 * world_step);
  }
}

TEST_CASE(
    "over a body that lies askew, uv and sweep are in that body's frame; an untextured ball has no texture of its own") {
  for (const Representation representation : {Representation::relief, Representation::normal}) {
    CAPTURE(int(representation));
    World world(smooth_floor(4), light_material(0), options_for(representation));
    const Vec3 half(0.3, 0.05, 0.3);
    ShapeBody table;
    table.shape = contact::Box{half};
    const surface::Placement top({0, half.y(), 0}, Quat::Identity(), 0.6, 0.6);
    const Quat upside_down(Eigen::AngleAxisd(pi, Vec3::UnitX()));
    table.faces = {waves({{0, -half.y(), 0}, upside_down, 0.6, 0.6}, 0), waves(top, 0)};
    table.material = light_material(0);
    table.motion = Motion::fixed;
    table.pose = {{0.2, 0.5, -0.1}, Quat(Eigen::AngleAxisd(0.7, Vec3::UnitY()))};
    const BodyId under = world.add(table);
    SphereBody ball;
    ball.radius = 0.02;
    ball.material = light_material(0);
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
    CHECK(track.way == doctest::Approx(std::hypot(0.2, 0.1) * 299 * world_step).epsilon(0.01));
    CHECK(track.worst < 0.01 * 0.22 * world_step);
  }
}

TEST_CASE("a block that slides on its own texture stands still on it") {
  World world(smooth_floor(4), light_material(0), options_for(Representation::normal));
  const Vec3 half(0.1, 0.05, 0.1);
  ShapeBody block;
  block.shape = contact::Box{half};
  const Quat upside_down(Eigen::AngleAxisd(pi, Vec3::UnitX()));
  block.faces = {waves({{0, -half.y(), 0}, upside_down, 0.2, 0.2}, 0.001)};
  block.material = light_material(0);
  block.pose.position = {0, half.y() + 1e-5, 0};
  block.velocity = {0.3, 0, 0};
  world.add(block);
  int count = 0;
  for (int k = 0; k < 200; ++k) {
    world.step();
    for (const ContactEvent& event : world.events()) {
      if (event.phase == ContactPhase::end) continue;
      REQUIRE(event.own);
      CHECK(event.own->sweep.norm() < 1e-3);
      CHECK(std::abs(event.v_t.x() - 0.3) < 1e-3);
      ++count;
    }
  }
  CHECK(count > 200);
}

TEST_CASE("a block that slides fast touches with the corners of its own texture, however coarse the steps") {
  for (const Representation representation : {Representation::relief, Representation::normal}) {
    CAPTURE(int(representation));
    WorldOptions coarse = options_for(representation);
    coarse.step = 1.0 / 60;
    coarse.most_substeps = 1;
    World world(smooth_floor(8), light_material(0), coarse);
    const Vec3 half(0.1, 0.05, 0.1);
    ShapeBody block;
    block.shape = contact::Box{half};
    const Quat upside_down(Eigen::AngleAxisd(pi, Vec3::UnitX()));
    block.faces = {tests::made_surface(
        8, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); }, 0,
        {{0, -half.y(), 0}, upside_down, 0.2, 0.2})};
    block.material = light_material(0);
    block.pose.position = {-2, half.y() + 1e-5, 0};
    block.velocity = {4, 0, 0};  // 7 cm a step
    world.add(block);
    int count = 0;
    for (int k = 0; k < 60; ++k) {
      world.step();
      for (const ContactEvent& event : world.events()) {
        if (event.phase == ContactPhase::end) continue;
        REQUIRE(event.own);
        // Two reliefs touch at their outermost texels, boxes at their corners.
        const Vec2 from_middle = (event.own->uv - Vec2(0.5, 0.5)).cwiseAbs();
        const double from_texel = (from_middle - Vec2(0.5 - 0.5 / 8, 0.5 - 0.5 / 8)).norm();
        const double from_corner = (from_middle - Vec2(0.5, 0.5)).norm();
        CHECK(std::min(from_corner, from_texel) < 1e-3);
        ++count;
      }
    }
    CHECK(count > 100);
  }
}

TEST_CASE(
    "a ball on a plain body sweeps its own texture, added first or last, and whether or not that body moves") {
  const double radius = 0.05;
  for (const Motion motion : {Motion::free, Motion::fixed}) {
    for (const bool ball_first : {true, false}) {
      CAPTURE(int(motion));
      CAPTURE(ball_first);
      World world(smooth_floor(4), light_material(1), options_for(Representation::normal));
      ShapeBody plank, ball = skinned_ball(radius, 0.002);
      const Vec3 half(0.6, 0.05, 0.2);
      plank.shape = contact::Box{half};
      plank.material = light_material(1);
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
      CHECK(track.way == doctest::Approx(0.3 * 300 * world_step * 0.3 / (2 * pi * radius)).epsilon(0.1));
      CHECK(track.worst < 0.02 * 0.3 * world_step);
    }
  }
}
