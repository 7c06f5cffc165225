#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

#include "core/portable_math.h"
#include "haptics/pen.h"
#include "haptics/servo.h"
#include "intaglio/representation.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

Vec3 random_vector(Random& random, double size) {
  return size * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
}

std::shared_ptr<const surface::Surface> flat_square(const Vec3& centre = Vec3::Zero(),
                                                    const Quat& turn = Quat::Identity()) {
  return tests::made_surface(
      8, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); }, 0.01,
      surface::Placement(centre, turn, 2, 2));
}

}  // namespace

TEST_CASE("the torque of a shaft pressed into flat ground matches the closed form") {
  // A line at depth d0 + e s (with the radius), s along the shaft, is pushed by k (d0 + e s) per metre along
  // the normal. From the taper's end a to the length l, with the arm s - grip:
  //     F = k (d0 (l - a) + e (l^2 - a^2) / 2),     M = k integral of (s - grip) (d0 + e s) ds.
  const auto s = flat_square();
  const TexturedSlab slab(s, {});
  Random random(5);
  PenShape shape;
  shape.shaft_stiffness = 20000;
  for (int n = 0; n < 2000; ++n) {
    shape.length = random.uniform(0.1, 0.2);
    shape.taper = random.uniform(0, 0.04);
    shape.grip = random.uniform(0, shape.length);
    const double azimuth = random.uniform(0, 6.28), sink = random.uniform(-0.02, 0.02);
    const Vec3 up =
        Vec3(std::cos(azimuth) * std::cos(sink), -std::sin(sink), std::sin(azimuth) * std::cos(sink));
    const Vec3 tip(random.uniform(-0.3, 0.3), -0.008, random.uniform(-0.3, 0.3));
    const double d0 = 0.008 + shape.radius, e = std::sin(sink);
    if (d0 + e * shape.length < 0) continue;
    const double a = shape.taper, l = shape.length, k = shape.shaft_stiffness;
    const auto moment = [&](int p) { return (std::pow(l, p + 1) - std::pow(a, p + 1)) / (p + 1); };
    const double force = k * (d0 * moment(0) + e * moment(1));
    const double arm = k * (d0 * moment(1) + e * moment(2)) - shape.grip * force;
    const Wrench wrench = shaft_wrench(slab, shape, {tip, up});
    CHECK((wrench.force - force * Vec3::UnitY()).norm() <= 1e-9 * force);
    CHECK((wrench.torque - arm * up.cross(Vec3::UnitY())).norm() <= 1e-9 * force * l);
  }
}

TEST_CASE("the shaft's wrench is the derivative of its energy") {
  const auto s = tests::rough_surface(64, 64, surface::Edge::wrap, 0.02);
  const TexturedSlab slab(s, {Representation::relief, 0.02});
  PenShape shape;
  shape.shaft_stiffness = 20000;
  Random random(6);
  int touching = 0;
  for (int n = 0; n < 300; ++n) {
    PenPose pose{random_vector(random, 0.2), random_vector(random, 1).normalized()};
    pose.tip.y() = -0.006;
    if (pose.up.y() < 0) pose.up = -pose.up;
    pose.up = (pose.up + 0.01 * Vec3::UnitX()).normalized();
    const Wrench wrench = shaft_wrench(slab, shape, pose);
    const double energy = shaft_energy(slab, shape, pose);
    if (energy < 1e-4) continue;
    ++touching;
    const Vec3 direction = random_vector(random, 1), axis = random_vector(random, 1).normalized();
    constexpr double h = 1e-7;
    const auto at = [&](double move, double turn) {
      const Quat q(Eigen::AngleAxisd(turn, axis));
      PenPose moved{pose.at(shape.grip) + move * direction, q * pose.up};
      moved.tip -= shape.grip * moved.up;
      return shaft_energy(slab, shape, moved);
    };
    const double slope = (at(h, 0) - at(-h, 0)) / (2 * h), twist = (at(0, h) - at(0, -h)) / (2 * h);
    CHECK(std::abs(-wrench.force.dot(direction) - slope) <= 1e-4 * wrench.force.norm() + 1e-6);
    CHECK(std::abs(-wrench.torque.dot(axis) - twist) <= 1e-4 * wrench.force.norm() * shape.length + 1e-6);
  }
  CHECK(touching > 20);
}

TEST_CASE("the wrench of tip, shaft and ball is the sum of r x f, wherever the world's origin is") {
  Random random(8);
  for (int n = 0; n < 200; ++n) {
    const Vec3 shift = random_vector(random, 100);
    const Quat turn(Eigen::AngleAxisd(random.uniform(0, 3), random_vector(random, 1).normalized()));
    Wrench here, there;
    Vec3 here_ball, there_ball;
    const Vec3 tip = random_vector(random, 0.05) - Vec3(0, 0.051, 0);
    for (const bool moved : {false, true}) {
      const auto to = [&](const Vec3& p) -> Vec3 { return moved ? Vec3(turn * p + shift) : p; };
      const auto s = moved ? flat_square(to(Vec3::Zero()), turn) : flat_square();
      const TexturedSlab slab(s, {});
      PenShape shape;
      shape.shaft_stiffness = 5000;
      const PenPose pose{to(tip), (moved ? turn : Quat::Identity()) * Vec3(0.9, 0.1, 0.2).normalized()};
      Wrench sum = shaft_wrench(slab, shape, pose);
      Proxy proxy;
      const auto contact = proxy.move(slab, pose.tip, ContactSprings::for_felt_stiffness(800), 0.3);
      sum += Wrench::of(contact.force, pose.tip, pose.at(shape.grip));
      SceneBall ball;
      ball.radius = 0.03;
      ball.position = to(tip + Vec3(0.05, 0.03, 0.01));
      const BallContact touch = touch_ball(shape, pose, Vec3::Zero(), ball, 800, 1);
      sum += Wrench::of(touch.force, touch.point, pose.at(shape.grip));
      (moved ? there : here) = sum;
      (moved ? there_ball : here_ball) = touch.force;
    }
    CHECK((there.force - turn * here.force).norm() <= 1e-9 * (1 + here.force.norm()));
    CHECK((there.torque - turn * here.torque).norm() <= 1e-9 * (1 + here.torque.norm()));
    CHECK((there_ball - turn * here_ball).norm() <= 1e-9 * (1 + here_ball.norm()));
  }
}

TEST_CASE("a wrench moved to another reference point has the torque r x f about it") {
  Random random(9);
  for (int n = 0; n < 1000; ++n) {
    const Vec3 f = random_vector(random, 5), at = random_vector(random, 1), a = random_vector(random, 1),
               b = random_vector(random, 1);
    const Wrench moved = Wrench::of(f, at, a).about(b - a);
    CHECK((moved.torque - Wrench::of(f, at, b).torque).norm() <= 1e-12);
  }
}

TEST_CASE("pen and ball push each other with opposite forces") {
  struct Held : Device {
    Vec3 position = Vec3(0, 0.1, 0);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    Vec3 read() override { return position; }
    void write(const GuardedForce& f) override { force = f.newtons(), torque = f.newton_metres(); }
  } device;
  ServoOptions options;
  options.limits.peak_torque = 0.5;
  options.limits.continuous_torque = 0.3;
  options.limits.continuous_force = 7.9;
  options.pen.direction = Vec3::UnitY();
  for (const double scale : {1.0, 5.0}) {
    options.workspace.scale = scale;
    PenServo servo(flat_square(), options);
    SceneSnapshot scene;
    scene.ball_count = 2;
    scene.balls[1].radius = 0.03;
    // 2 mm of device travel into the shaft, half way up.
    scene.balls[1].position =
        options.workspace.to_world(device.position) + Vec3(0.035 - 0.002 * scale, 0.075, 0);
    ServoSample sample;
    for (int k = 1; k <= 1000; ++k) {
      scene.time = k * 1e-3;
      sample = servo.tick(device, scene, scene.time);
    }
    CHECK(sample.touching_ball);
    CHECK(device.force.x() == doctest::Approx(-600 * 0.002));
    // The arm is in the world; the force there is smaller by the scale.
    CHECK(device.torque.z() == doctest::Approx(600 * 0.002 / scale * (0.075 - options.pen.grip)));
    CHECK(servo.report().ball_impulse[1].x() == doctest::Approx(600 * 0.002 / scale));
    CHECK(servo.report().ball_impulse[0] == Vec3::Zero());
  }
}
