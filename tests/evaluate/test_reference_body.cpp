// Laws of a box and a hull on the reference, on planes and reliefs of which everything is known.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/reference_body.h"
#include "surface/recipes/builtin.h"
#include "surface/surface.h"

namespace intaglio::evaluate {

namespace {

constexpr double gravity = 9.81;  // m/s^2

// z = -a (1 - cos(2 pi x / wave)) / 2 along x, on a metre; without amplitude a plane.
Reference waves_of(double amplitude, int count, int grid) {
  surface::Texels texels;
  texels.width = texels.height = grid / 2;
  for (int j = 0; j < texels.height; ++j) {
    for (int i = 0; i < texels.width; ++i) {
      const double phase = 2 * std::numbers::pi * count * (i + 0.5) / texels.width;
      texels.depth.push_back(float(0.5 * (1 - std::cos(phase))));
      texels.normal.push_back(
          Vec3(amplitude * std::numbers::pi * count * std::sin(phase), 0, 1).normalized());
    }
  }
  texels.colour = Image8(1, 1, 3);
  return {surface::Surface(std::move(texels), {Vec3::Zero(), Quat::Identity(), 1, 1}, amplitude,
                           surface::Edge::wrap),
          grid};
}

const Reference& plane() {
  static const Reference flat = waves_of(0, 1, 256);
  return flat;
}

Material plastic() {
  return *find_material("plastic");
}
Material brick() {
  return *find_material("brick");
}

void run(ReferenceBody& body, double seconds) {
  for (int k = 0; k < int(std::lround(seconds * reference_rate)); ++k) body.step();
}

// Points of a sphere, evenly spread (Fibonacci's spiral).
contact::ConvexHull round_hull(double radius, int count) {
  std::vector<Vec3> points;
  for (int k = 0; k < count; ++k) {
    const double z = 1 - 2 * (k + 0.5) / count, turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
    points.push_back(radius *
                     Vec3(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z));
  }
  return make_hull(points).value();
}

const Vec3 half(0.03, 0.02, 0.04);

}  // namespace

TEST_CASE("A reference box in flight falls freely, and keeps its energy and angular momentum") {
  ReferenceBody box(plane(), box_form(half), plastic(), brick());
  const Vec3 spin(3, 7, -2);
  box.put({{{0.5, 0.5, 3}, rotation(0.7, Vec3(1, 2, 3).normalized())}, {0.4, 0, 0.2}, spin});
  const double energy = box.energy();
  const ConvexForm form = box_form(half);
  const auto momentum = [&] {
    const Quat& q = box.state().pose.orientation;
    return Vec3(q * (form.inertia * (q.conjugate() * box.state().angular_velocity)));
  };
  const Vec3 before = momentum();
  run(box, 0.5);
  // The integrator's own error of free fall is g dt / 2 times the time.
  const double slack = 0.5 * gravity / reference_rate * 0.5;
  CHECK(std::abs(box.state().pose.position.z() - (3 + 0.2 * 0.5 - 0.5 * gravity * 0.25)) < 1.01 * slack);
  CHECK((momentum() - before).norm() < 1e-9 * before.norm());
  CHECK(std::abs(box.energy() - energy) < box.mass() * gravity * slack * 2);
  CHECK((box.state().angular_velocity - spin).norm() > 0.3);  // it precesses
}

TEST_CASE(
    "A reference box that is dropped flat bounces by its restitution, rests at half its height, and stays") {
  ReferenceBody box(plane(), box_form(half), plastic(), brick());
  box.put({{{0.5, 0.5, half.z() + 0.05}, Quat::Identity()}, Vec3::Zero(), Vec3::Zero()});
  double highest = 0;
  bool touched = false;
  for (int k = 0; k < int(0.25 * reference_rate); ++k) {
    box.step();
    touched = touched || box.touches();
    if (touched) highest = std::max(highest, box.state().pose.position.z() - half.z());
  }
  const double e = plastic().restitution * brick().restitution;
  CHECK(highest == doctest::Approx(0.05 * e * e).epsilon(0.01));
  run(box, 1.5);
  const Vec3 at = box.state().pose.position;
  CHECK(std::abs(at.z() - half.z()) < 2e-5);
  CHECK(box.state().velocity.norm() < 1e-3);
  run(box, 0.5);
  CHECK((box.state().pose.position - at).norm() < 1e-5);
  CHECK(std::abs(box.gap_at(box.state().pose, 1e-3)) < 2e-5);
}

TEST_CASE(
    "A reference box that slides on a plane stops after v^2 / (2 mu g), and what pushes it is its momentum") {
  const double mu = std::sqrt(plastic().friction * brick().friction), speed = 0.6;
  // Low enough that it does not tip over.
  const Vec3 low(0.04, 0.04, 0.01);
  ReferenceBody box(plane(), box_form(low), plastic(), brick());
  box.put({{{0.3, 0.5, low.z()}, Quat::Identity()}, {speed, 0, 0}, Vec3::Zero()});
  double stopped = 0;
  for (int k = 0; k < int(0.5 * reference_rate); ++k) {
    const Vec3 before = box.state().velocity;
    box.step();
    Vec3 pushed = Vec3::Zero();
    for (const TouchPoint& touch : box.touch_points()) pushed += touch.impulse;
    const Vec3 gained = box.mass() * (box.state().velocity - before + Vec3(0, 0, gravity / reference_rate));
    CHECK((gained - pushed).norm() < 1e-9);
    if (stopped == 0 && box.state().velocity.x() < 1e-3) stopped = double(k + 1) / reference_rate;
  }
  CHECK(box.state().pose.position.x() - 0.3 ==
        doctest::Approx(speed * speed / (2 * mu * gravity)).epsilon(0.002));
  CHECK(stopped == doctest::Approx(speed / (mu * gravity)).epsilon(0.005));
  // Friction is opposite to slip, so that an oblique slide is straight and does not turn the box.
  box.put({{{0.3, 0.5, low.z()}, Quat::Identity()}, {speed, 0.2, 0}, Vec3::Zero()});
  run(box, 0.1);
  CHECK(box.state().velocity.y() / box.state().velocity.x() == doctest::Approx(0.2 / speed).epsilon(0.01));
  CHECK(std::abs(box.state().angular_velocity.z()) < 0.03);
}

TEST_CASE("Boxes and hulls on reliefs gain no energy and sink nowhere") {
  const Reference relief(surface::find_builtin("brick").value(), {1, 1}, 0.02, 512);
  Random random(3);
  std::vector<Vec3> points;
  for (int k = 0; k < 14; ++k)
    points.emplace_back(random.uniform(-0.04, 0.04), random.uniform(-0.04, 0.04),
                        random.uniform(-0.04, 0.04));
  const Vec3 centre = mass_properties(make_hull(points).value()).centre;
  for (Vec3& point : points) point -= centre;
  for (const ConvexForm& form : {box_form(half), hull_form(make_hull(points).value())}) {
    ReferenceBody body(relief, form, plastic(), brick());
    body.put({{{0.3, 0.3, 0.1}, rotation(0.4, Vec3(1, 1, 0).normalized())}, {0.4, 0.2, 0}, {4, -3, 2}});
    const double first = body.energy();
    double before = first, deepest = 0;
    for (int k = 0; k < int(1.0 * reference_rate); ++k) {
      body.step();
      CHECK(body.energy() < before + 2e-4 * std::abs(first));
      before = body.energy();
      if (k % 40 == 0)
        if (const double gap = body.gap_at(body.state().pose, 1e-3); std::isfinite(gap))
          deepest = std::min(deepest, gap);
    }
    CHECK(body.energy() < first);
    CHECK(deepest > -1e-3);
  }
}

TEST_CASE("A round hull of many corners rests in a trough where a ball does") {
  const Reference relief = waves_of(0.02, 2, 512);
  const double radius = 0.03;
  ReferenceBody hull(relief, hull_form(round_hull(radius, 250)), plastic(), brick());
  const double z = relief.rest_on({0.25, 0.5}, radius).z + radius;
  hull.put({{{0.25, 0.5, z + 0.002}, Quat::Identity()}, Vec3::Zero(), Vec3::Zero()});
  run(hull, 1);
  // Its faces lie up to 1 - cos(half their width) inside the sphere.
  const double inside = radius * (1 - std::cos(2.0 / std::sqrt(250.0)));
  const Vec3 at = hull.state().pose.position;
  const double ball = relief.rest_on(at.head<2>(), radius).z + radius;
  CHECK(at.z() < ball + 5e-5);
  CHECK(at.z() > ball - inside - 5e-5);
  const auto normals = hull.normals_at(hull.state().pose, 5e-4);
  REQUIRE(!normals.empty());
}

TEST_CASE("The normals of a reference box on a plane are those of the plane") {
  ReferenceBody box(plane(), box_form(half), plastic(), brick());
  for (const double lean : {0.0, 0.3, 0.9}) {
    const Quat turn = rotation(lean, Vec3(1, 0.3, 0).normalized());
    double lowest = 1;
    for (const Vec3& corner : box_form(half).corners) lowest = std::min(lowest, (turn * corner).z());
    const Pose pose{{0.4, 0.6, -lowest + 1e-4}, turn};
    const auto normals = box.normals_at(pose, 3e-4);
    REQUIRE(!normals.empty());
    for (const Vec3& normal : normals) CHECK((normal - Vec3::UnitZ()).norm() < 1e-9);
    CHECK(box.gap_at(pose, 1e-3) == doctest::Approx(1e-4).epsilon(1e-6));
  }
}

}  // namespace intaglio::evaluate
