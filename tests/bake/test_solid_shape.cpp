#include <doctest/doctest.h>

#include <cmath>

#include "sound/bake/bake.h"
#include "sound/bake/fem/tet_mesh.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;

TEST_CASE("shapes by name have their volume, and no more elements than allowed") {
  for (const char* text :
       {"sphere:r=0.05", "box:x=0.3,y=0.01,z=0.2", "plate:a=0.3,t=0.01", "cylinder:h=0.2,r=0.02"}) {
    CAPTURE(text);
    CHECK(is_solid_shape(text));
    const auto shape = solid_shape(text);
    REQUIRE(shape);
    const TetMesh mesh = shape->mesh(0.01, 5000);
    CHECK(mesh.tets.size() <= 5000);
    CHECK(volume(mesh) == doctest::Approx(shape->volume()).epsilon(0.005));
  }
}

TEST_CASE("what is no shape is said so") {
  for (const char* text :
       {"sphere:", "sphere:r=", "sphere:r=-1", "sphere:r=nan", "sphere:q=1", "box:x=1,y=1", "plate:a=1,t=1e9",
        "cylinder:r=0.1,,h=1", "sphere:r=0.1x", "sphere:r=0.05,r=0.1", "box:x=1,y=1,z=1,y=1"}) {
    CAPTURE(text);
    const auto shape = solid_shape(text);
    REQUIRE_FALSE(shape);
    CHECK(shape.error().message().find("write it like") != std::string::npos);
  }
  CHECK_FALSE(is_solid_shape("sphere.obj"));
  CHECK_FALSE(is_solid_shape("sphere"));
  CHECK_FALSE(is_solid_shape("C:r=1"));
}

TEST_CASE("elements shrink with frequency, but not for modes that are not requested") {
  const auto size = [](double hertz, int count) {
    return element_size(0.09 * 0.01, 2 * 0.09, test::steel(), {count, 20, hertz});
  };
  CHECK(size(2000, 1000) > size(10'000, 1000));
  // Rigid modes count, too.
  CHECK(size(1e6, 100) == doctest::Approx(std::sqrt(1006.0 / 106) * size(1e6, 1000)));
}
