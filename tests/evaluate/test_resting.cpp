// Rest of bodies: on a plane, where the truth is simple, and by numbers that the test invents.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "evaluate/resting.h"

namespace intaglio::evaluate {

TEST_CASE("statistics of rest count bodies that rest, and only those") {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  const RestStatistics s = rest_statistics({{BodyKind::ball, true, -2, nothing, 1.5, 0},
                                            {BodyKind::box, true, 1, 4, 0, 0.2},
                                            {BodyKind::hull, true, 0, 2, 0.5, 0.4},
                                            {BodyKind::hull, false, nothing, nothing, nothing, nothing}});
  CHECK(s.bodies == 4);
  CHECK(s.at_rest == doctest::Approx(0.75));
  CHECK(s.height_mm == doctest::Approx(1));
  CHECK(s.tilt == doctest::Approx(3));
  CHECK(s.sunk == doctest::Approx(1.0 / 3));
  CHECK(s.creep_mm == doctest::Approx(0.2));
  const RestStatistics none = rest_statistics({});
  CHECK(std::isnan(none.at_rest));
  CHECK(std::isnan(none.height_mm));
}

TEST_CASE("drops are balls, boxes and hulls by turns, the same for the same seed") {
  const auto drops = plan_drops(3, 9, 1), again = plan_drops(3, 9, 1), other = plan_drops(4, 9, 1);
  REQUIRE(drops.size() == 9);
  for (std::size_t k = 0; k < 9; ++k) {
    CHECK(int(drops[k].kind) == int(k % 3));
    CHECK(drops[k].start.pose.position == again[k].start.pose.position);
    CHECK(drops[k].start.pose.position != other[k].start.pose.position);
  }
}

TEST_CASE("on a plane bodies rest truly, and on a relief those of a flat floor do not") {
  SubjectOptions options;
  options.grid = 512;
  options.depth = 1e-6;
  const Subject plane = Subject::make(options).value();
  const auto drops = plan_drops(1, 6, 1);
  const RestStatistics flat = rest_statistics(rests(plane, candidates()[0], drops));
  CHECK(flat.at_rest > 0.6);
  CHECK(flat.height_mm < 0.2);
  CHECK(flat.tilt < 1);
  CHECK(flat.sunk == 0);
  CHECK(flat.creep_mm < 0.5);
  options.depth = 0.02;
  const Subject deep = Subject::make(options).value();
  const RestStatistics wrong = rest_statistics(rests(deep, candidates()[0], drops));
  CHECK(wrong.height_mm > 1);
}

}  // namespace intaglio::evaluate
