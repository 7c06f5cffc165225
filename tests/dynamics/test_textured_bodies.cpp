// Textured bodies that move, and curved floors, in a World: momentum, energy, rest, events.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "dynamics/world.h"
#include "dynamics/world_state.h"
#include "intaglio/representation.h"
#include "tests/dynamics/worlds.h"
#include "tests/mesh/curved_bases.h"

using namespace intaglio;
using namespace intaglio::dynamics;
using std::numbers::pi;
using tests::g;
using tests::grating_depth;
using tests::grating_period;
using tests::light_material;

namespace {

// Ridges across u on a square, a ridge under its middle; or none.
std::shared_ptr<const surface::Surface> grating(double side, const surface::Placement& placement,
                                                double deep = grating_depth) {
  const auto phase = [=](Vec2 uv) { return 2 * pi * (uv.x() - 0.5) * side / grating_period; };
  return tests::made_surface(
      int(std::lround(side / 0.01)), [=](Vec2 uv) { return 0.5 + 0.5 * std::cos(phase(uv)); },
      [](Vec2) { return Vec3::UnitZ(); }, deep, placement);
}

std::shared_ptr<const surface::Surface> flat_floor(double side) {
  return grating(side, tests::flat_placement(side), 0);
}

// A block with gratings below or above.
ShapeBody block(const Vec3& position, bool below, bool above, const Vec3& half = {0.16, 0.05, 0.16}) {
  ShapeBody out;
  out.shape = contact::Box{half};
  out.material = light_material(0.3);
  out.pose.position = position;
  const Quat upside_down(Eigen::AngleAxisd(pi, Vec3::UnitX()));
  const double side = 2 * half.x();
  if (below) out.faces.push_back(grating(side, {Vec3(0, -half.y(), 0), upside_down, side, side}));
  if (above) out.faces.push_back(grating(side, {Vec3(0, half.y(), 0), Quat::Identity(), side, side}));
  return out;
}

// A ball with bumps.
ShapeBody rough_ball(double radius, const Vec3& position, double deep = 0.004) {
  const auto bumps = tests::made_surface(
      96,
      [](Vec2 uv) {
        const double u = std::sin(6 * pi * uv.x()), v = std::sin(6 * pi * uv.y());
        return 1 - u * u * v * v;
      },
      [](Vec2) { return Vec3::UnitZ(); }, deep);
  ShapeBody out;
  out.shape = contact::Sphere{radius};
  out.skin = tests::relief_on(surface::make_sphere(radius, 48, 24), bumps);
  out.material = light_material(0.4);
  out.pose.position = position;
  return out;
}

// Checks a world against conservation laws, second by second.
struct Laws {
  World& world;
  std::vector<ShapeBody> bodies;
  Vec3 gravity;
  double first = 0, highest = 0, rise = 0, lowest = 0, error = 0;
  std::vector<Vec3> before;

  Laws(World& w, std::vector<ShapeBody> of, const Vec3& pull)
      : world(w), bodies(std::move(of)), gravity(pull) {
    for (const ShapeBody& body : bodies) world.add(body);
    first = highest = lowest = energy();
    for (std::size_t k = 0; k < bodies.size(); ++k) before.push_back(world.velocity(id(k)));
  }
  static BodyId id(std::size_t k) { return BodyId(k + 1); }
  double mass(std::size_t k) const { return bodies[k].mass(); }
  // J, of all bodies.
  double energy() const {
    double sum = 0;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const contact::MassProperties is = mass_properties(bodies[k]);
      const Pose at = world.pose(id(k));
      const Vec3 spin = at.orientation.conjugate() * world.angular_velocity(id(k));
      sum += 0.5 * mass(k) * world.velocity(id(k)).squaredNorm() +
             0.5 * bodies[k].material.density * spin.dot(is.inertia * spin) -
             mass(k) * gravity.dot(at.to_world(is.centre));
    }
    return sum;
  }
  // J, m g r of a body.
  double scale() const {
    double sum = 0;
    for (std::size_t k = 0; k < bodies.size(); ++k) sum += mass(k) * gravity.norm() * reach(bodies[k]);
    return sum;
  }
  // Sums every event's impulse on its body, and its opposite on the other, to compare with the change of
  // momentum.
  void run(double seconds, double rate) {
    for (int n = 0; n < seconds * rate; ++n) {
      world.step();
      std::map<BodyId, Vec3> got;
      for (const ContactEvent& e : world.events()) {
        got.try_emplace(e.body, Vec3::Zero()).first->second += e.impulse;
        if (!is_surface(e.other)) got.try_emplace(e.other, Vec3::Zero()).first->second -= e.impulse;
      }
      for (std::size_t k = 0; k < bodies.size(); ++k) {
        const Vec3 now = world.velocity(id(k));
        const Vec3 wanted = mass(k) * (now - before[k] - gravity / rate);
        if (got.count(id(k)) != 0 && now.norm() > 0)
          error = std::max(error, (got[id(k)] - wanted).norm() / (mass(k) * gravity.norm() / rate));
        before[k] = now;
      }
      const double e = energy();
      highest = std::max(highest, e);
      rise = std::max(rise, e - lowest);
      lowest = std::min(lowest, e);
    }
  }
  std::string say() const {
    return fmt::format(
        "energy over the first {:.2g}, greatest rise {:.2g} of m g r; impulses off by {:.2g} m g dt",
        (highest - first) / scale(), rise / scale(), error);
  }
};

WorldOptions at_rate(double rate) {
  WorldOptions options;
  options.step = 1 / rate;
  options.report_pairs = true;
  return options;
}

}  // namespace

TEST_CASE("gratings of one period hold a slope that flat blocks slide down") {
  for (const bool textured : {true, false}) {
    WorldOptions options = at_rate(240);
    const double angle = 20 * pi / 180;
    options.gravity = g * Vec3(std::sin(angle), -std::cos(angle), 0);
    World world(textured ? grating(2.4, tests::flat_placement(2.4)) : flat_floor(2.4), light_material(0.3),
                options);
    Laws laws(world, {block({-0.36, textured ? 0.0301 : 0.0501, 0}, textured, false)}, options.gravity);
    laws.run(1, 240);
    const double moved = world.pose(1).position.x() + 0.36;
    MESSAGE(std::string(textured ? "gratings" : "flat")
            << " moved " << 1000 * moved << " mm; " << laws.say());
    if (textured) {
      CHECK(std::abs(moved) < 0.01 * grating_period);
    } else {
      CHECK(moved == doctest::Approx(0.5 * g * (std::sin(angle) - 0.3 * std::cos(angle))).epsilon(0.02));
    }
    CHECK(laws.rise < 1e-4 * laws.scale());
    CHECK(laws.error < 1e-3);
  }
}

TEST_CASE("a stack of two free gratings settles, rests and stays; events name both bodies and the place") {
  World world(flat_floor(2), light_material(0.5), at_rate(240));
  Laws laws(world, {block({0, 0.0502, 0}, false, true), block({0, 0.135, 0}, true, false)}, {0, -g, 0});
  int begun = 0, ended = 0;
  for (int n = 0; n < 480; ++n) {
    laws.run(1.0 / 240, 240);
    for (const ContactEvent& e : world.events()) {
      if (is_surface(e.other)) continue;
      CHECK(e.body == 1);
      CHECK(e.other == 2);
      CHECK(e.n_g.dot(Vec3::UnitY()) == doctest::Approx(-1).epsilon(1e-3));
      CHECK(std::abs(e.point.y() - 0.09) < 0.011);
      // The face is turned down, so its v is reversed.
      CHECK((e.uv - Vec2(0.5 + e.point.x() / 0.32, 0.5 + e.point.z() / 0.32)).norm() < 0.01);
      begun += e.phase == ContactPhase::begin ? 1 : 0;
      ended += e.phase == ContactPhase::end ? 1 : 0;
    }
  }
  const Pose settled = world.pose(2);
  CHECK(begun > 0);
  MESSAGE(begun << " begun, " << ended << " ended; " << laws.say() << "; upper at "
                << settled.position.transpose() << ", speeds " << world.velocity(1).norm() << " "
                << world.velocity(2).norm());
  // Ridges in grooves.
  CHECK(settled.position.y() == doctest::Approx(0.13).epsilon(0.01));
  CHECK(laws.rise < 1e-6 * laws.scale());
  CHECK(laws.error < 1e-3);
  laws.run(3, 240);
  CHECK((world.pose(2).position - settled.position).norm() < 1e-6);
  CHECK(world.velocity(2).norm() == 0);
  CHECK(world.events().empty());
}

TEST_CASE("balls lie on the relief of one free slab and on the plain back of another") {
  World world(flat_floor(2), light_material(0.5), at_rate(240));
  ShapeBody ball;
  ball.shape = contact::Sphere{0.03};
  ball.material = light_material(0.4);
  ball.pose.position = {0.02, 0.16, 0.01};
  ShapeBody other = ball;
  other.pose.position = {0.62, 0.16, 0.01};
  Laws laws(world, {block({0, 0.0502, 0}, false, true), block({0.6, 0.0502, 0}, true, false), ball, other},
            {0, -g, 0});
  laws.run(4, 240);
  MESSAGE(laws.say() << "; " << world.pose(3).position.transpose() << ", "
                     << world.pose(4).position.transpose());
  // In the middle groove: its bottom is at 8 cm, and it is too narrow for the ball.
  CHECK(std::abs(world.pose(3).position.x()) < 1e-4);
  CHECK(world.pose(3).position.y() > 0.11);
  CHECK(world.pose(3).position.y() < 0.115);
  CHECK(world.pose(4).position.y() == doctest::Approx(world.pose(2).position.y() + 0.08).epsilon(1e-3));
  for (BodyId k = 1; k <= 4; ++k) CHECK(world.velocity(k).norm() == 0);
  CHECK(laws.rise < 1e-4 * laws.scale());
  CHECK(world.momentum_residual() < 1e-3 * laws.mass(2) * g / 240);
}

TEST_CASE("blocks with gratings tumble onto a grating, gain no energy, and none falls through") {
  World world(grating(2.4, tests::flat_placement(2.4)), light_material(0.5), at_rate(480));
  std::vector<ShapeBody> blocks;
  for (int k = 0; k < 3; ++k) {
    blocks.push_back(block({0.1 * k, 0.3 + 0.25 * k, 0}, true, true));
    blocks.back().pose.orientation = Quat(Eigen::AngleAxisd(0.4 * k + 0.2, Vec3(1, 0.3, 0.5).normalized()));
  }
  Laws laws(world, blocks, {0, -g, 0});
  laws.run(tests::is_sampled() ? 0.7 : 5, 480);
  MESSAGE(laws.say() << "; residual " << world.momentum_residual() / (laws.mass(0) * g / 480) << " m g dt");
  for (BodyId k = 1; k <= 3; ++k) {
    CHECK(world.pose(k).position.y() > 0.029);
    if (!tests::is_sampled()) CHECK(world.velocity(k).norm() < 1e-3);
  }
  CHECK(laws.highest == laws.first);
  CHECK(laws.rise < 1e-4 * laws.scale());
  CHECK(world.momentum_residual() < 1e-3 * laws.mass(0) * g / 480);
}

TEST_CASE("a relief ball rolls on a relief floor and pushes a relief block away" *
          doctest::test_suite("statistics")) {
  World world(grating(2.4, tests::flat_placement(2.4), 0.004), light_material(0.5), at_rate(240));
  ShapeBody ball = rough_ball(0.1, {-0.4, 0.105, 0.02});
  ball.velocity = {0.8, 0, 0};
  ball.angular_velocity = {0, 0, -8};
  ShapeBody wall = block({0.1, 0.0502, 0}, false, false, {0.05, 0.05, 0.05});
  const Quat on_side(Eigen::AngleAxisd(pi / 2, Vec3::UnitZ()));
  wall.faces = {grating(0.1, {Vec3(-0.05, 0, 0), on_side, 0.1, 0.1}, 0.004)};
  Laws laws(world, {ball, wall}, {0, -g, 0});
  bool met = false;
  for (int n = 0; n < 3 * 240 / (tests::is_sampled() ? 6 : 1); ++n) {
    laws.run(1.0 / 240, 240);
    for (const ContactEvent& e : world.events())
      met = met || (e.body == 1 && e.other == 2 && e.n_g.x() < -0.9);
  }
  MESSAGE(laws.say() << " at " << world.pose(1).position.transpose() << ", block at "
                     << world.pose(2).position.transpose());
  if (!tests::is_sampled()) {
    CHECK(met);
    CHECK(world.pose(2).position.x() > 0.101);
  }
  CHECK(laws.rise < 1e-3 * laws.scale());
  CHECK(world.momentum_residual() < 1e-3 * laws.mass(1) * g / 240);
}

TEST_CASE("a ball and a box come to rest in a relief bowl; without relief the bowl is smooth" *
          doctest::test_suite("statistics")) {
  const auto bowl =
      tests::relief_on(tests::tiled(surface::make_bowl(0.5, 96, 48), {4, 2}), tests::brick_surface(128));
  for (const auto representation : {Representation::relief, Representation::flat}) {
    WorldOptions options = at_rate(240);
    options.representation = representation;
    World world(bowl, light_material(0.5), options);
    ShapeBody ball;
    ball.shape = contact::Sphere{0.03};
    ball.material = light_material(0.4, 0.3);
    ball.material.rolling_resistance = 0.01;
    ball.pose.position = {0.3, -0.25, 0.05};
    ShapeBody box = ball;
    box.shape = contact::Box{{0.04, 0.03, 0.05}};
    box.pose.position = {-0.2, -0.35, 0.05};
    Laws laws(world, {ball, box}, {0, -g, 0});
    int said = 0;
    for (int n = 0; n < 4 * 240 / (tests::is_sampled() ? 6 : 1); ++n) {
      laws.run(1.0 / 240, 240);
      for (const ContactEvent& e : world.events()) {
        if (e.other != floor_body) continue;
        ++said;
        // The bowl's normal points to its middle everywhere.
        CHECK(e.n_g.dot(-e.point.normalized()) > 0.999);
        CHECK(e.point.norm() < 0.525);
        CHECK(e.uv.y() > 0);
      }
    }
    CHECK(said > (tests::is_sampled() ? 0 : 100));
    const Vec3 at = world.pose(1).position;
    MESSAGE(laws.say() << "; ball at " << at.transpose() << ", " << at.norm() << " m from the middle");
    if (!tests::is_sampled()) {
      CHECK(at.norm() > 0.46);
      CHECK(at.norm() < 0.495);
      CHECK(world.velocity(2).norm() < 1e-3);
    }
    CHECK(laws.highest == laws.first);
    CHECK(laws.rise < 1e-4 * laws.scale());
    CHECK(world.momentum_residual() < 1e-3 * laws.mass(0) * g / 240);
  }
}

TEST_CASE(
    "a box with gratings above and below comes to rest in a relief bowl; the upper one touches nothing" *
    doctest::test_suite("statistics")) {
  const auto bowl =
      tests::relief_on(tests::tiled(surface::make_bowl(0.5, 96, 48), {4, 2}), tests::brick_surface(128));
  World world(bowl, light_material(0.5), at_rate(240));
  ShapeBody box = block({-0.1, -0.38, 0.05}, true, true, {0.08, 0.04, 0.08});
  box.velocity = {0.3, 0, 0.2};
  Laws laws(world, {box}, {0, -g, 0});
  std::size_t met = 0;
  for (int n = 0; n < 2 * 240 / (tests::is_sampled() ? 4 : 1); ++n) {
    laws.run(1.0 / 240, 240);
    for (const ContactEvent& e : world.events()) {
      ++met;
      // Pushed towards the bowl's middle.
      CHECK(e.n_s.dot(-e.point) > 0);
    }
  }
  MESSAGE(laws.say() << "; at " << world.pose(1).position.transpose());
  CHECK(met > (tests::is_sampled() ? 0 : 100));
  CHECK(world.pose(1).position.norm() < 0.5);
  if (!tests::is_sampled()) CHECK(world.velocity(1).norm() < 0.01);
  CHECK(laws.highest == laws.first);
  // It slides to rest on a few summits, and correcting overlaps lifts it slightly.
  CHECK(laws.rise < 5e-3 * laws.scale());
}

TEST_CASE("two relief balls touch a relief bowl and each other, and gain no energy" *
          doctest::test_suite("statistics")) {
  const auto bowl =
      tests::relief_on(tests::tiled(surface::make_bowl(0.5, 64, 32), {4, 2}), tests::brick_surface(64));
  World world(bowl, light_material(0.5), at_rate(240));
  ShapeBody left = rough_ball(0.08, {-0.0825, -0.41, 0}), right = rough_ball(0.08, {0.0825, -0.41, 0});
  left.velocity = {0.3, 0, 0};
  Laws laws(world, {left, right}, {0, -g, 0});
  std::size_t on_floor = 0, on_other = 0;
  for (int n = 0; n < 20; ++n) {
    laws.run(1.0 / 240, 240);
    for (const ContactEvent& e : world.events()) (e.other == floor_body ? on_floor : on_other) += 1;
  }
  MESSAGE(laws.say() << "; " << on_floor << " contacts with the bowl, " << on_other << " with each other; at "
                     << world.pose(1).position.transpose() << " and " << world.pose(2).position.transpose());
  CHECK(on_floor > 10);
  CHECK(on_other > 0);
  for (const BodyId id : {1, 2}) CHECK(world.pose(id).position.norm() < 0.45);
  CHECK((world.pose(1).position - world.pose(2).position).norm() > 0.14);
  CHECK(laws.highest == laws.first);
  CHECK(world.momentum_residual() < 1e-3 * laws.mass(0) * g / 240);
}

TEST_CASE("two textured bodies collide in free space: momentum is conserved, energy does not rise") {
  WorldOptions options = at_rate(480);
  options.gravity.setZero();
  // The floor is far below.
  World world(grating(1, {Vec3(0, -5, 0), Quat::Identity(), 1, 1}), light_material(0.5), options);
  ShapeBody falling = block({0.03, 0.2, 0.01}, true, false);
  falling.velocity = {0, -0.5, 0};
  Laws laws(world, {block({0, 0, 0}, false, true), falling}, {0, 0, 0});
  const Vec3 before = laws.mass(1) * falling.velocity;
  const double first = laws.energy();
  laws.run(1.5, 480);
  const Vec3 after = laws.mass(0) * world.velocity(1) + laws.mass(1) * world.velocity(2);
  MESSAGE("momentum off by " << (after - before).norm() / before.norm() << ", energy " << laws.highest - first
                             << " of " << first << " J over the first, " << laws.energy() << " left");
  CHECK((after - before).norm() < 1e-5 * before.norm());
  CHECK(laws.highest - first < 1e-6 * first);
  CHECK(world.velocity(1).y() < -0.1);
}

TEST_CASE("an open skin and a skin without size report that they are not simulated") {
  World world(flat_floor(2), light_material(0.5), at_rate(240));
  ShapeBody open = rough_ball(0.1, {0, 1, 0});
  open.skin = tests::relief_on(surface::make_bowl(0.1, 24, 12), tests::no_relief());
  const BodyId id = world.add(open);
  world.step();
  CHECK((world.status(id) & not_simulated) != 0);
  CHECK(world.pose(id).position.y() == 1);
}
