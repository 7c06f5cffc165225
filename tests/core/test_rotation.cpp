#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "core/portable_math.h"
#include "intaglio/vec.h"

using namespace intaglio;

TEST_CASE("the shortest rotation of one direction onto another: Eigen's, and half a turn for opposite ones") {
  Random random(1);
  const auto any = [&] {
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = random.uniform(-1, 1);
    return v;
  };
  for (int k = 0; k < 1000; ++k) {
    const Vec3 from = any(), to = any();
    const Quat q = rotation_onto(from, to);
    CHECK((q * from.normalized() - to.normalized()).norm() < 1e-12);
    CHECK(q.coeffs() == Quat::FromTwoVectors(from, to).coeffs());
    const Quat half = rotation_onto(from, -from);
    CHECK((half * from + from).norm() < 1e-12);
    CHECK(half.norm() == doctest::Approx(1));
  }
}
