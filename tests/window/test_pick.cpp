// What the mouse meets on a curved base.
#include <doctest/doctest.h>

#include "mesh/triangle_mesh.h"
#include "window/view_camera.h"

using namespace intaglio;

TEST_CASE("a ray into a bowl meets its inside, not its back; one beside it meets nothing") {
  const surface::TriangleMesh bowl = surface::make_bowl(0.5, 128, 64);
  const Vec3 eye(0.3, 1, 0.2), down = -Vec3::UnitY();
  const auto met = window::pick_base(bowl, eye, down);
  REQUIRE(met);
  CHECK(met->point.norm() == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(met->point.x() == doctest::Approx(0.3));
  CHECK((met->normal + met->point.normalized()).norm() < 0.03);
  // From the side the near wall shows its back: the far one is met.
  const auto far = window::pick_base(bowl, Vec3(0, -0.2, 2), -Vec3::UnitZ());
  REQUIRE(far);
  CHECK(far->point.z() < 0);
  CHECK_FALSE(window::pick_base(bowl, eye + Vec3(1, 0, 0), down));
  CHECK_FALSE(window::pick_base(bowl, eye, Vec3::UnitY()));
}
