#include <doctest/doctest.h>

#include <cmath>

#include "sound/bake/fem/fill_surface.h"
#include "sound/bake/fem/inside.h"
#include "sound/bake/fem/modes.h"
#include "tests/bake/surfaces.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

// The worst relative error of the first modes, which come in the order of `hertz`.
double worst_error(const TetMesh& mesh, const Material& material, const std::vector<double>& hertz) {
  const auto modes = free_modes(assemble(mesh, material), {int(hertz.size()), 20, 1e6});
  if (!modes) MESSAGE(modes.error().message());
  REQUIRE(modes);
  REQUIRE(modes->angular_frequency.size() == Eigen::Index(hertz.size()));
  double worst = 0;
  for (std::size_t i = 0; i < hertz.size(); ++i)
    worst = std::max(worst, std::abs(modes->angular_frequency[Eigen::Index(i)] / (tau * hertz[i]) - 1));
  return worst;
}

std::vector<double> lamb(double radius, const Material& material) {
  std::vector<double> eta(5, 2.50113);
  eta.insert(eta.end(), 5, 2.64622);
  eta.insert(eta.end(), 3, 3.52999);
  eta.insert(eta.end(), 7, 3.86470);
  eta.insert(eta.end(), 7, 3.93740);
  for (double& e : eta) e *= std::sqrt(material.shear_modulus() / material.density) / (tau * radius);
  return eta;
}

std::string refusal(const surface::TriangleMesh& mesh, double size) {
  const auto filled = test::fill_surface(mesh, {size, 20'000}, "body.obj");
  REQUIRE_FALSE(filled);
  const std::string message = filled.error().message();
  CHECK(message.find('\n') == std::string::npos);
  CHECK(message.starts_with("body.obj"));
  return message;
}

}  // namespace

TEST_CASE("winding numbers: 1 inside, 0 outside, and a tree says what the sum over all triangles says") {
  const auto ball = test::icosphere(1, 3);
  const WindingNumber winding(ball.positions, ball.triangles);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.9, 0, 0.2), Vec3(-0.3, 0.9, 0)})
    CHECK(winding.value(p) == doctest::Approx(1).epsilon(0.01));
  for (const Vec3& p : {Vec3(0, 0, 1.05), Vec3(3, 0, 0.2), Vec3(-1, 1, -1)})
    CHECK(std::abs(winding.value(p)) < 0.02);
}

TEST_CASE("an icosphere fills to a ball with Lamb's frequencies within 0.3 %" *
          doctest::test_suite("statistics")) {
  const auto filled = test::fill_surface(test::icosphere(0.1, 4), {0.03, 20'000}, "ball.obj");
  REQUIRE(filled);
  const double worst = worst_error(filled->mesh, test::steel(), lamb(0.1, test::steel()));
  MESSAGE("ball, " << filled->mesh.tets.size() << " elements: " << 100 * worst << " %");
  CHECK(worst < 0.003);
}

TEST_CASE("a bar along the axes, and turned askew" * doctest::test_suite("statistics")) {
  const std::vector<double> hertz{257.19, 501.40, 698.11, 1160.15, 1305.99, 1339.39};
  const auto bar = test::cuboid({1, 0.1, 0.05});
  const auto straight = test::fill_surface(bar, {0.03, 20'000}, "bar.obj");
  REQUIRE(straight);
  const double exact = worst_error(straight->mesh, test::steel(), hertz);
  MESSAGE("bar, " << straight->mesh.tets.size() << " elements: " << 100 * exact << " %");
  CHECK(exact < 0.005);
  const auto askew = test::fill_surface(
      test::turned(bar, Quat(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()))), {0.03, 20'000}, "bar.obj");
  if (!askew) MESSAGE(askew.error().message());
  REQUIRE(askew);
  const double cut = worst_error(askew->mesh, test::steel(), hertz);
  MESSAGE("bar askew, " << askew->mesh.tets.size() << " elements: " << 100 * cut << " %");
  CHECK(cut < 0.005);
}

TEST_CASE(
    "a dirty ball rings as a clean one: holes, turned and doubled triangles, slivers, a crossing shell" *
    doctest::test_suite("statistics")) {
  const auto clean = test::icosphere(0.1, 3);
  auto dirty = clean;
  for (std::size_t t = 0; t < dirty.triangles.size(); t += 7)
    std::swap(dirty.triangles[t][0], dirty.triangles[t][1]);
  auto inside_out = clean;
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  auto open = clean;
  open.triangles.erase(open.triangles.begin() + 100, open.triangles.begin() + 110);
  auto doubled = clean;
  doubled.triangles.insert(doubled.triangles.end(), clean.triangles.begin(), clean.triangles.begin() + 20);
  doubled.triangles.push_back({0, 0, 5});
  const auto crossed = test::together(clean, test::icosphere(0.05, 2), Vec3(0.04, 0, 0));
  const double volume_of_clean = volume(test::fill_surface(clean, {0.05, 20'000}, "clean.obj").value().mesh);
  for (const auto& mesh : {dirty, inside_out, open, doubled, crossed}) {
    const auto filled = test::fill_surface(mesh, {0.05, 20'000}, "dirty.obj");
    if (!filled) MESSAGE(filled.error().message());
    REQUIRE(filled);
    CHECK_FALSE(filled->notes.empty());
    CHECK(volume(filled->mesh) == doctest::Approx(volume_of_clean).epsilon(0.01));
    CHECK(worst_error(filled->mesh, test::steel(), lamb(0.1, test::steel())) < 0.02);
  }
}

TEST_CASE("a cavity stays a cavity") {
  auto inner = test::icosphere(0.06, 3);
  for (auto& t : inner.triangles) std::swap(t[0], t[1]);
  const auto filled = test::fill_surface(test::together(test::icosphere(0.1, 3), inner, Vec3::Zero()),
                                         {0.03, 20'000}, "hollow.obj");
  REQUIRE(filled);
  CHECK(volume(filled->mesh) == doctest::Approx(4.0 / 3 * tau / 2 * (0.001 - 0.000216)).epsilon(0.02));
}

TEST_CASE("surfaces without a solid body are rejected in one line that gives the reason") {
  const auto ball = test::icosphere(0.1, 2);
  auto sheet = test::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}});
  CHECK(refusal(sheet, 0.1).find("no volume") != std::string::npos);
  sheet.positions[3].z() = 0.3;  // not planar, but still without an inside
  refusal(sheet, 0.1);
  CHECK(refusal(test::mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}), 0.1).find("volume") !=
        std::string::npos);
  CHECK(refusal(test::mesh_of({}, {}), 0.1).find("no triangles") != std::string::npos);
  CHECK(refusal(test::together(ball, ball, Vec3(0.5, 0, 0)), 0.05).find("2 disconnected parts") !=
        std::string::npos);
  CHECK(refusal(test::cuboid({1, 1, 0.001}), 0.1).find("thick") != std::string::npos);
  auto bowl = test::icosphere(0.1, 3);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.positions[std::size_t(t[0])].y() > 0; });
  CHECK(refusal(bowl, 0.05).find("is open") != std::string::npos);
}
