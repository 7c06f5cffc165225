#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/shape.h"
#include "tests/contact/bodies.h"

using namespace intaglio;
using namespace intaglio::contact;

TEST_CASE("the hull of a grid of points is its box: six faces, twelve edges, eight corners") {
  std::vector<Vec3> points;
  for (int k = 0; k < 125; ++k) points.emplace_back(k % 5 * 0.1, k / 5 % 5 * 0.2, k / 25 * 0.3);
  const auto hull = convex_hull(points);
  REQUIRE(hull);
  CHECK((*hull)->faces.size() == 6);
  CHECK((*hull)->edges.size() == 12);
  CHECK((*hull)->vertices.size() == 8);
  CHECK((*hull)->neighbours.size() == 24);
}

TEST_CASE("all points are in their hull, and Euler's formula holds") {
  for (const int count : {4, 5, 12, 60, 256}) {
    const auto points = tests::points_on_ellipsoid(count, Vec3(0.1, 0.05, 0.2), std::uint64_t(count));
    const auto hull = convex_hull(points);
    REQUIRE(hull);
    CHECK((*hull)->vertices.size() == points.size());
    CHECK((*hull)->vertices.size() + (*hull)->faces.size() == (*hull)->edges.size() + 2);
    for (const Vec3& p : points) {
      for (const auto& face : (*hull)->faces) CHECK(face.normal.dot(p) <= face.offset + 1e-12);
    }
  }
}

TEST_CASE("a hull keeps its faces and its volume to rounding when it is turned, and in any order of points") {
  Random random(7);
  for (int round = 0; round < 20; ++round) {
    const Quat turn = tests::any_turn(random);
    std::vector<Vec3> points;
    for (int k = 0; k < 125; ++k)
      points.emplace_back(turn * Vec3(k % 5 * 0.1, k / 5 % 5 * 0.2, k / 25 * 0.3));
    const auto hull = convex_hull(points);
    REQUIRE(hull);
    CHECK((*hull)->faces.size() == 6);
    CHECK((*hull)->vertices.size() == 8);
    CHECK(mass_properties(ConvexHull{*hull}).volume == doctest::Approx(0.4 * 0.8 * 1.2).epsilon(1e-13));
    std::reverse(points.begin(), points.end());
    const auto other = convex_hull(points);
    REQUIRE(other);
    CHECK((*other)->faces.size() == 6);
    CHECK(mass_properties(ConvexHull{*other}).volume == doctest::Approx(0.4 * 0.8 * 1.2).epsilon(1e-13));
  }
}

TEST_CASE("a hull keeps bevels and thicknesses of a millionth of its size") {
  Random random(8);
  const Quat turn = tests::any_turn(random);
  std::vector<Vec3> bevelled, plate;
  for (int k = 0; k < 8; ++k) {
    const Vec3 sign(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 corner = (1 - 1e-6) * sign;
      corner[axis] = sign[axis];
      bevelled.push_back(turn * corner);
    }
    plate.push_back(turn * sign.cwiseProduct(Vec3(0.5, 0.5, 0.5e-6)));
  }
  const auto box = convex_hull(bevelled), thin = convex_hull(plate);
  REQUIRE(box);
  CHECK((*box)->vertices.size() == 24);
  CHECK((*box)->faces.size() == 26);
  REQUIRE(thin);
  CHECK(mass_properties(ConvexHull{*thin}).volume == doctest::Approx(1e-6).epsilon(1e-9));
}

TEST_CASE("a hull of thousands of points has the corners of its outermost ones") {
  std::vector<Vec3> points = tests::points_on_ellipsoid(200, Vec3(0.1, 0.05, 0.2), 3);
  const std::size_t corners = points.size();
  for (const Vec3& p : tests::points_on_ellipsoid(20'000, Vec3(0.05, 0.025, 0.1), 4)) points.push_back(p);
  const auto hull = convex_hull(points);
  REQUIRE(hull);
  CHECK((*hull)->vertices.size() == corners);
}

TEST_CASE("points without a hull and meshes that are not closed are refused in one line") {
  const std::vector<Vec3> flat = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.3, 0.4, 0}};
  CHECK_FALSE(convex_hull(flat));
  CHECK_FALSE(convex_hull(std::vector<Vec3>(10, Vec3(1, 2, 3))));
  CHECK_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}));
  CHECK_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}}));
  CHECK_FALSE(convex_hull(std::vector<Vec3>{}));
  CHECK_FALSE(convex_hull(tests::points_on_ellipsoid(300, Vec3::Ones(), 3)));
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  using Triangles = std::vector<std::array<int, 3>>;
  CHECK(closed_mesh(corners, Triangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}));
  for (const Triangles& bad :
       {Triangles{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}, Triangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}},
        Triangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 4}},
        Triangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 2, 3}},
        Triangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}}, Triangles{}}) {
    const auto mesh = closed_mesh(corners, bad);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().message().find('\n') == std::string::npos);
  }
}

TEST_CASE("mass: closed forms, hulls and meshes agree; a body in parts weighs what the whole does") {
  const Vec3 half(0.1, 0.2, 0.3);
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(half.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)) +
                      Vec3(1, 2, 3));
  const MassProperties box = mass_properties(Box{half}),
                       hull = mass_properties(ConvexHull{*convex_hull(corners)});
  CHECK(box.volume == doctest::Approx(0.048));
  CHECK(hull.volume == doctest::Approx(box.volume));
  CHECK((hull.centre - Vec3(1, 2, 3)).norm() < 1e-9);
  CHECK((hull.inertia - box.inertia).norm() < 1e-9 * box.inertia.norm());
  const Vec3 part(0.1, 0.1, 0.3);
  const MassProperties two = mass_properties(make_compound(
      {{Box{part}, {Vec3(0, 0.1, 0), Quat::Identity()}}, {Box{part}, {Vec3(0, -0.1, 0), Quat::Identity()}}}));
  CHECK(two.volume == doctest::Approx(box.volume));
  CHECK((two.inertia - box.inertia).norm() < 1e-12);
  // A prism of many sides is nearly a cylinder; a capsule is a cylinder and a ball cut in two.
  std::vector<Vec3> ring;
  for (int k = 0; k < 120; ++k) {
    const double a = 2 * std::numbers::pi * k / 120;
    ring.emplace_back(0.1 * std::cos(a), 0.2, 0.1 * std::sin(a));
    ring.emplace_back(0.1 * std::cos(a), -0.2, 0.1 * std::sin(a));
  }
  const MassProperties prism = mass_properties(ConvexHull{*convex_hull(ring)}),
                       tube = mass_properties(Cylinder{0.1, 0.2});
  CHECK(prism.volume == doctest::Approx(tube.volume).epsilon(1e-3));
  CHECK((prism.inertia - tube.inertia).norm() < 2e-3 * tube.inertia.norm());
  const MassProperties capsule = mass_properties(Capsule{0.1, 0.2}), ball = mass_properties(Sphere{0.1});
  CHECK(capsule.volume == doctest::Approx(tube.volume + ball.volume));
  CHECK(capsule.inertia(1, 1) == doctest::Approx(tube.inertia(1, 1) + ball.inertia(1, 1)));
  const double size = 0.2, thick = 0.08;
  CHECK(mass_properties(tests::angle_bracket(size)).volume ==
        doctest::Approx(thick * (size * size - (size - thick) * (size - thick))));
}
