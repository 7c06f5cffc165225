// Bodies against reliefs on curved bases; test_relief_closest.cpp covers the sphere's exactness.
#include <algorithm>
#include <cmath>

#include "contact/curved_contacts.h"
#include "contact/surface_contacts.h"
#include "core/portable_math.h"
#include "mesh/relief_closest.h"
#include "tests/contact/bodies.h"
#include "tests/count_allocations.h"
#include "tests/mesh/curved_bases.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

void check_sound(const ContactSet& set) {
  CHECK(set.count <= ContactSet::capacity);
  for (const ContactPoint& c : set) {
    CHECK((c.point.allFinite() && c.normal.allFinite() && c.n_s.allFinite() && c.uv.allFinite()));
    CHECK(std::isfinite(c.distance));
    CHECK(std::abs(c.normal.norm() - 1) < 1e-9);
    CHECK(std::abs(c.n_s.norm() - 1) < 1e-6);
  }
}

// Negative inside, minus the distance to the nearest face; outside not negative.
double signed_distance(const Shape& shape, const Vec3& x) {
  if (const auto* s = std::get_if<Capsule>(&shape))
    return (x - Vec3(0, std::clamp(x.y(), -s->half_height, s->half_height), 0)).norm() - s->radius;
  if (const auto* s = std::get_if<Box>(&shape)) return (x.cwiseAbs() - s->half).maxCoeff();
  double height = -1e300;
  for (const auto& face : std::get<ConvexHull>(shape).form->faces)
    height = std::max(height, face.normal.dot(x) - face.offset);
  return height;
}

}  // namespace

TEST_CASE("on a flat quad a sphere's contacts are those with the rectangle") {
  const auto s = tests::rough_surface(40, 32, surface::Edge::clamp, 0.3, 5);
  const auto relief = tests::relief_on(surface::make_quad(s->placement()), s);
  Random random(71);
  int touching = 0;
  for (int k = 0; k < tests::poses(300, 10000); ++k) {
    const Pose pose{Vec3(random.uniform(-0.4, 0.4), random.uniform(0.01, 0.045), random.uniform(-0.25, 0.25)),
                    Quat::Identity()};
    const ContactSet flat = relief_contacts(*s, Sphere{0.04}, pose, 0.005),
                     curved = curved_contacts(relief, Sphere{0.04}, pose, 0.005);
    CHECK(flat.count == curved.count);
    for (std::size_t n = 0; n < std::min(flat.count, curved.count); ++n) {
      ++touching;
      CHECK(curved.points[n].distance == doctest::Approx(flat.points[n].distance).epsilon(1e-9));
      CHECK((curved.points[n].point - flat.points[n].point).norm() < 1e-9);
      CHECK((curved.points[n].normal - flat.points[n].normal).norm() < 1e-6);
      CHECK((curved.points[n].n_s - flat.points[n].n_s).norm() < 1e-6);
      CHECK((curved.points[n].uv - flat.points[n].uv).norm() < 1e-9);
    }
  }
  MESSAGE(touching << " contacts compared");
  CHECK(touching > 200);
}

TEST_CASE("a body lifted off along its first contact's normal no longer overlaps there; nothing allocates" *
          doctest::test_suite("statistics")) {
  for (const auto& [name, relief, radius, is_torn] : tests::various_reliefs()) {
    for (const auto& [kind, shape] : tests::bodies(2 * radius)) {
      Random random(72);
      int touched = 0, lifted = 0;
      double worst = 0;
      for (int k = 0; k < tests::poses(30, 1000); ++k) {
        Pose pose{tests::near_relief(random, relief, 0.1 * radius, 0.8 * radius), tests::any_turn(random)};
        const std::size_t before = allocations();
        const ContactSet set = curved_contacts(relief, shape, pose, 0.1 * radius);
        CHECK(allocations() == before);
        check_sound(set);
        for (std::size_t n = 1; n < set.count; ++n)
          CHECK(set.points[n].distance >= set.points[n - 1].distance);
        if (set.count == 0 || set.points[0].distance >= 0) continue;
        ++touched;
        const double deep = -set.points[0].distance;
        pose.position += (deep + 1e-9) * set.points[0].normal;
        const double left = -tests::first_distance(curved_contacts(relief, shape, pose, 0), 0);
        // Another place may overlap instead, by less.
        lifted += left < 1e-6 ? 1 : 0;
        worst = std::max(worst, left / deep);
      }
      MESSAGE(name << ", " << kind << ": " << lifted << " of " << touched
                   << " are free after one lift, the rest overlap by " << 100 * worst << " % at most");
      CHECK(touched > 5);
      // A ball has one closest point, and what it overlaps beside it, it overlaps by less.
      if (kind == "sphere" && !is_torn) CHECK(worst < 0.05);
    }
  }
}

TEST_CASE("the depth of capsule, box and hull agrees with samples of the field" *
          doctest::test_suite("statistics")) {
  for (const auto& [name, relief, radius, is_torn] : tests::various_reliefs()) {
    struct Point {
      Vec3 at, normal;  // of the base
    };
    std::vector<Point> field;
    Random random(73);
    for (int k = 0; k < 100000; ++k) {
      const int triangle = tests::any_triangle(random, relief.base());
      const Vec3 weights = tests::any_weights(random);
      field.push_back({relief.point(triangle, weights), relief.base().at(triangle, weights).n});
    }
    for (const std::string kind : {"capsule", "box", "hull"}) {
      const Shape shape = tests::body(kind, 2 * radius).shape;
      double worst = 0;
      int touched = 0;
      for (int k = 0; k < tests::poses(25, 1000); ++k) {
        const Pose pose{tests::near_relief(random, relief, 0.45 * radius, 1.1 * radius),
                        tests::any_turn(random)};
        const double ours = tests::first_distance(curved_contacts(relief, shape, pose, 0), 0);
        // No sample that faces its nearest face of the body is deeper in the body than the first contact.
        double deepest = 0;
        for (const Point& p : field) {
          const Vec3 local = pose.to_local(p.at);
          const double depth = signed_distance(shape, local);
          if (depth >= deepest) continue;
          const Vec3 n = pose.orientation.conjugate() * p.normal;
          if (signed_distance(shape, local - 1e-7 * n) > depth) deepest = depth;
        }
        touched += deepest < 0 ? 1 : 0;
        worst = std::max(worst, ours - deepest);
      }
      MESSAGE(name << ", " << kind << ": " << touched << " overlap; a sample deeper by " << 1e3 * worst
                   << " mm at most");
      CHECK(worst < 2e-4 * relief.texel_size());
    }
  }
}

TEST_CASE("a feature keeps its name while the body turns about it, and on either side of an edge") {
  const auto relief = tests::relief_on(surface::make_sphere(0.5, 24, 12), tests::no_relief());
  // A vertex of the mesh: on its normal the name is one, wherever the ball is about.
  const Vec3 vertex = relief.base().mesh().positions[30], n = vertex.normalized();
  Random random(74);
  std::uint64_t name = 0;
  for (int k = 0; k < 50; ++k) {
    const Vec3 at = vertex + 0.05 * (n + 0.02 * tests::any_vector(random, 1)).normalized();
    const ContactSet set = curved_contacts(relief, Sphere{0.05}, {at, Quat::Identity()}, 0.001);
    REQUIRE(set.count > 0);
    if (k == 0) name = set.points[0].feature;
    CHECK(set.points[0].feature == name);
  }
}

TEST_CASE("invalid bodies on a curved base get a status") {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const auto relief = tests::relief_on(surface::make_sphere(0.5, 24, 12), tests::brick_surface(32));
  const Quat upright = Quat::Identity();
  const auto asked = [&](const Shape& shape, const Pose& pose, double margin = 0.001) {
    const ContactSet set = curved_contacts(relief, shape, pose, margin);
    check_sound(set);
    return set;
  };
  for (const auto& [name, shape] : tests::bodies(0.1)) {
    const std::string kind = name;  // clang-14 captures no structured bindings
    CAPTURE(kind);
    CHECK(asked(shape, {Vec3(nan, 0, 0), upright}).status == status::bad_pose);
    CHECK(asked(shape, {Vec3(0, 0.5, 0), Quat(0, 0, 0, 0)}).status == status::bad_pose);
    CHECK(asked(shape, {Vec3(0, 1e6, 0), upright}).status == status::far);
    CHECK(asked(shape, {Vec3(0, 2, 0), upright}).status == status::ok);
    CHECK((asked(shape, {Vec3::Zero(), upright}).status & status::under) != 0);
    CHECK(asked(shape, {Vec3::Zero(), upright}).count == 0);
    CHECK((asked(shape, {Vec3(0.51, 0, 0), upright}, infinity).status & status::wide_margin) != 0);
    CHECK((asked(shape, {Vec3(0.51, 0, 0), upright}, nan).status & status::wide_margin) != 0);
    CHECK(asked(shape, {Vec3(0.51, 0.02, 0), upright}, -1).count > 0);
    // As deep as it is large it is still pushed out.
    const ContactSet deep = asked(shape, {Vec3(0.45, 0.02, 0.01), upright});
    REQUIRE(deep.count > 0);
    CHECK(deep.points[0].normal.x() > 0.5);
  }
  CHECK(asked(Sphere{0}, {Vec3(0.5, 0, 0), upright}).status == status::no_size);
  CHECK(asked(Sphere{nan}, {Vec3(0.5, 0, 0), upright}).status == status::no_size);
  CHECK(asked(Box{Vec3(0.1, -1, 0.1)}, {Vec3(0.5, 0, 0), upright}).status == status::no_size);
  CHECK(asked(ConvexHull{}, {Vec3(0.5, 0, 0), upright}).status == status::no_size);
}
