#include <doctest/doctest.h>

#include <limits>

#include "core/portable_math.h"
#include "tests/count_allocations.h"
#include "tests/mesh/mesh_shapes.h"

using namespace intaglio;
using namespace intaglio::surface;
using namespace intaglio::tests;

TEST_CASE("queries do not allocate and accept any point") {
  const auto placement = MeshPlacement::make(make_sphere(0.5, 64, 32));
  REQUIRE(placement);
  Random random(7);
  const double inf = std::numeric_limits<double>::infinity();
  const std::size_t before = allocations();
  int found = 0;
  for (int k = 0; k < 1000; ++k) {
    const auto at = placement->closest(any_vector(random, 1), 0.4);
    if (at && placement->to_world(at->uv, at->height)) ++found;
  }
  for (const Vec3& p :
       {Vec3(inf, 0, 0), Vec3(0, std::nan(""), 0), Vec3(1e300, 1e300, 1e300), Vec3(1e30, 0, 0)}) {
    if (placement->closest(p, inf) && p.x() != 1e30) found = -1;
    if (placement->closest(p, 1)) found = -1;
  }
  CHECK(allocations() == before);
  CHECK(found > 100);
  CHECK_FALSE(placement->closest(Vec3(0.6, 0, 0), std::nan("")));
  CHECK_FALSE(placement->closest(Vec3(0.6, 0, 0), 0.05));
  CHECK(placement->closest(Vec3(0.6, 0, 0), 0.2));
}
