// Box, hull and ball of an evaluation: their forms, and candidates that are known to be right or wrong.
#include <doctest/doctest.h>

#include <cmath>

#include "evaluate/body_truth.h"
#include "evaluate/body_world.h"

namespace intaglio::evaluate {

namespace {

const Candidate& of(Kind kind) {
  return candidates()[std::size_t(kind)];
}

// The texture barely has a relief: every representation is nearly right.
const Subject& shallow() {
  static const Subject subject = [] {
    SubjectOptions options;
    options.depth = 1e-6;
    options.grid = 512;
    return Subject::make(options).value();
  }();
  return subject;
}

}  // namespace

TEST_CASE("The hull of an evaluation is irregular, centred, and in the frame of its principal axes") {
  const contact::Shape hull = body_shape(BodyKind::hull, 2);
  const contact::MassProperties mass = contact::mass_properties(hull);
  CHECK(mass.centre.norm() < 1e-9);
  const Vec3 moments = mass.inertia.diagonal();
  const Mat3 others = mass.inertia - Mat3(moments.asDiagonal());
  CHECK(others.norm() < 1e-9 * moments.norm());
  CHECK((moments.maxCoeff() - moments.minCoeff()) > 0.1 * moments.maxCoeff());
  CHECK(contact::bounding_radius(hull) > 0.05);
  CHECK(contact::bounding_radius(hull) < 0.15);
  const ConvexForm form = body_form(hull);
  CHECK(form.corners.size() + form.faces.size() == form.edges.size() + 2);  // Euler
  CHECK(form.volume == doctest::Approx(mass.volume));
}

TEST_CASE("Without relief, a thrown box and hull move in every world of ours as on the reference") {
  for (const BodyKind kind : {BodyKind::box, BodyKind::hull}) {
    CAPTURE(int(kind));
    // Slides from the start: no impact, which would part any two engines.
    const contact::Shape shape = body_shape(kind, 1);
    ThrowOptions options{.kind = kind, .start = {}, .seconds = 0.45};
    if (kind == BodyKind::box) {
      options.start.pose = {{0.4, 0.5, 0.025}, Quat::Identity()};
      options.start.velocity = {0.6, 0.1, 0};
    } else {
      options.start.pose = {{0.4, 0.5, 0.3}, Quat::Identity()};
      options.start.velocity = {0.3, 0, 1};
      // About a principal axis: Bullet keeps the velocity of a body in flight, not its angular momentum.
      options.start.angular_velocity = {0, 0, 5};
      options.seconds = 0.25;  // in flight
    }
    const ReferenceThrow truth = reference_throw(shallow(), options);
    REQUIRE(truth.states.size() > 800);
    for (const Kind candidate : {Kind::flat, Kind::relief, Kind::normal, Kind::mesh_256}) {
      // A box rattles over the edges of Bullet's triangles.
      if (candidate == Kind::mesh_256 && kind == BodyKind::box) continue;
      CAPTURE(std::string(of(candidate).key));
      const ThrowError error = throw_error(shallow(), of(candidate), truth);
      CHECK(error.place_mm < 0.5);
      // In flight, Euler's steps differ: by g t / 2 times the difference of their lengths.
      const double fall = 1000 * 0.5 * 9.81 * 0.1 * (1.0 / 480 - 1 / reference_rate);
      CHECK(std::abs(error.height_mm - (kind == BodyKind::hull ? fall : 0)) < 0.1);
      CHECK(error.turn < 0.2);
      if (kind == BodyKind::box) CHECK(error.normal_angle < 1);
    }
  }
}

TEST_CASE("A ball that rolls on a plane gains nothing, and one that is lifted by hand does") {
  BodyState start;
  start.pose.position = {0.3, 0.5, 0.04};
  start.velocity = {0.4, 0, 0};
  start.angular_velocity = Vec3::UnitZ().cross(start.velocity) / 0.04;
  // Not a mesh: a ball in Bullet jumps at the edges of triangles.
  for (const Kind candidate : {Kind::flat, Kind::relief, Kind::normal, Kind::relief_paper}) {
    CAPTURE(std::string(of(candidate).key));
    const EnergyRise rise = energy_rise(shallow(), of(candidate), start, 0.5);
    CHECK(rise.share < 2e-3);
    CHECK(rise.gained_j >= 0);
  }
  CHECK(reference_energy_rise(shallow(), start, 0.5).share < 2e-3);
  // The energy that is compared is that of the body: raised by a centimetre it has m g h more.
  BodyWorld world(shallow(), of(Kind::relief), contact::Sphere{0.04}, body_material());
  world.put(start);
  const double before = world.energy();
  start.pose.position.z() += 0.01;
  world.put(start);
  const double mass = body_material().density * 4.0 / 3 * 3.14159265 * 0.04 * 0.04 * 0.04;
  CHECK(world.energy() - before == doctest::Approx(mass * 9.81 * 0.01).epsilon(1e-4));
}

TEST_CASE("A flat floor has the wrong normals on a relief by the slope of the relief") {
  // Poses and normals that the test invents: 30 degrees off the plane's.
  const double lean = 0.5235987756;
  const std::vector<std::vector<Vec3>> normals = {{Vec3(std::sin(lean), 0, std::cos(lean))}, {}};
  const std::vector<Pose> poses(2, Pose{{0.5, 0.5, 0.04}, Quat::Identity()});
  CHECK(contact_normal_error(shallow(), of(Kind::flat), contact::Sphere{0.04}, poses, normals) ==
        doctest::Approx(30).epsilon(1e-3));
  const std::vector<Pose> high(1, Pose{{0.5, 0.5, 0.4}, Quat::Identity()});
  CHECK(contact_normal_error(shallow(), of(Kind::relief), contact::Sphere{0.04}, high, normals) == 90);
}

}  // namespace intaglio::evaluate
