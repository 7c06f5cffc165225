#include <doctest/doctest.h>

#include "core/clock.h"
#include "intaglio/event.h"

using intaglio::Clock;

TEST_CASE("every loop has a whole number of ticks a period") {
  const Clock clock({480, 1000, 44100, 30});
  for (const int rate : {480, 1000, 44100, 30}) CHECK(clock.ticks_per_second() % rate == 0);
}

TEST_CASE("loops do not drift: after an hour each has made exactly rate x 3600 steps") {
  const Clock clock({480, 1000, 44100, 30});
  for (const int rate : {480, 1000, 44100, 30})
    CHECK(clock.seconds(clock.due(std::int64_t{rate} * 3600, rate)) == 3600.0);
}

TEST_CASE("steps cover a duration and no more") {
  const Clock clock({30, 44100});
  CHECK(clock.steps(10.0, 44100) == 441000);
  CHECK(clock.steps(0.1, 30) == 3);
  CHECK(clock.steps(0.11, 30) == 4);
}
