#include <doctest/doctest.h>

#include <cmath>

#include "sound/bake/bake.h"
#include "sound/bake/fem/fill_surface.h"
#include "sound/bake/fem/tet_mesh.h"
#include "tests/bake/surfaces.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

// A square sheet in the xz plane, of n by n squares cut both ways.
surface::TriangleMesh sheet(double side, int n) {
  std::vector<Vec3> points;
  std::vector<surface::Triangle> faces;
  for (int k = 0; k <= n; ++k) {
    for (int i = 0; i <= n; ++i)
      points.emplace_back(side * (double(i) / n - 0.5), 0, side * (double(k) / n - 0.5));
  }
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) {
      const int a = k * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      if ((i + k) % 2 == 0) {
        faces.insert(faces.end(), {{a, c, b}, {a, d, c}});
      } else {
        faces.insert(faces.end(), {{a, d, b}, {b, d, c}});
      }
    }
  }
  return test::mesh_of(std::move(points), std::move(faces));
}

}  // namespace

TEST_CASE("linear elements have the same mass and are sharp in pitch, less so the smaller they are" *
          doctest::test_suite("statistics")) {
  const Vec3 size(0.3, 0.01, 0.3);
  const Material ceramic = *find_material("ceramic");
  const ModeOptions modes{3, 20, 20'000};
  double last = 1e9;
  for (const int n : {8, 16, 32}) {
    const TetMesh mesh = box(size, n, 2, n);
    const auto linear = bake_linear(mesh, ceramic, {"tile", modes});
    REQUIRE(linear);
    CHECK(linear->mass == doctest::Approx(2700 * 0.3 * 0.3 * 0.01));
    CHECK(linear->modes() == 3);
    const double first = linear->angular_frequency[0] / tau;
    MESSAGE("linear, " << n << " across: " << first << " Hz for 381.3");
    CHECK(first > 381.3);
    CHECK(first < last);
    last = first;
  }
}

TEST_CASE("a sheet with thickness is the plate" * doctest::test_suite("statistics")) {
  const auto body = body_surface(sheet(0.3, 10), "sheet.obj", 0.01);
  REQUIRE(body);
  CHECK(body->volume == doctest::Approx(0.3 * 0.3 * 0.01));
  const auto filled = fill_surface(*body, {0.014, 40'000}, "sheet.obj");
  REQUIRE(filled);
  CHECK(volume(filled->mesh) == doctest::Approx(0.3 * 0.3 * 0.01).epsilon(1e-3));
  const auto model = bake(filled->mesh, *find_material("ceramic"), {"sheet", {3, 20, 20'000}});
  REQUIRE(model);
  const double expected[] = {381.30, 554.54, 633.01};
  for (std::size_t m = 0; m < 3; ++m)
    CHECK(model->angular_frequency[m] / tau == doctest::Approx(expected[m]).epsilon(0.01));
}

TEST_CASE("an open bowl with a thickness rings" * doctest::test_suite("statistics")) {
  auto bowl = test::icosphere(0.1, 3);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.positions[std::size_t(t[0])].y() > 0; });
  const auto body = body_surface(bowl, "bowl.obj", 0.024);
  REQUIRE(body);
  const auto coarse = fill_surface(*body, {0.04, 40'000}, "bowl.obj");
  REQUIRE_FALSE(coarse);
  CHECK(coarse.error().message().find("--element-size 0.012") != std::string::npos);
  const auto filled = fill_surface(*body, {0.012, 40'000}, "bowl.obj");
  if (!filled) MESSAGE(filled.error().message());
  REQUIRE(filled);
  CHECK(volume(filled->mesh) == doctest::Approx(body->volume).epsilon(0.05));
  const auto model = bake(filled->mesh, test::steel(), {"bowl", {5, 20, 20'000}});
  REQUIRE(model);
  CHECK(model->modes() == 5);
}

TEST_CASE("a spring-mass shell: right mass, six rigid modes, a plate's bending but not its torsion") {
  const Material ceramic = *find_material("ceramic");
  const auto body = body_surface(sheet(0.3, 24), "sheet.obj", 0.01);
  REQUIRE(body);
  // Any number of rigid modes but six would be an error.
  const auto shell = bake_spring_shell(*body, 0.01, ceramic, {"sheet", {6, 20, 20'000}}, "sheet.obj");
  if (!shell) MESSAGE(shell.error().message());
  REQUIRE(shell);
  CHECK(shell->modes() == 7);  // the last is one of a pair
  MESSAGE("spring-mass tile: " << shell->angular_frequency[0] / tau << " Hz for 381.3, then "
                               << shell->angular_frequency[1] / tau << " for 554.5");
  // Springs along the edges are a third too stiff in torsion, a tile's first mode; its second bends.
  CHECK(shell->angular_frequency[0] / tau == doctest::Approx(381.3).epsilon(0.35));
  CHECK(shell->angular_frequency[1] / tau == doctest::Approx(554.5).epsilon(0.05));
  CHECK(shell->mass > 0);
  // Bending scales with the thickness, the springs' own modes do not.
  const auto thin = bake_spring_shell(*body, 0.005, ceramic, {"sheet", {6, 20, 20'000}}, "sheet.obj");
  REQUIRE(thin);
  CHECK(shell->angular_frequency[0] / thin->angular_frequency[0] == doctest::Approx(2).epsilon(0.01));

  // A ball of shell: closed, and stiff against bending everywhere.
  const auto round = body_surface(test::icosphere(0.1, 3), "ball.obj", 0.003);
  const auto ball_shell = bake_spring_shell(*round, 0.003, ceramic, {"ball", {5, 20, 40'000}}, "ball.obj");
  if (!ball_shell) MESSAGE(ball_shell.error().message());
  REQUIRE(ball_shell);
  CHECK(ball_shell->modes() == 5);
}
