#include <doctest/doctest.h>

#include <limits>

#include "window/sdl_window.h"

using namespace intaglio::window;

TEST_CASE("panels are as large as the screen's dots ask, once: not again where the desktop enlarges") {
  CHECK(panel_scale(96, 1) == 1);
  CHECK(panel_scale(192, 1) == 2);
  CHECK(panel_scale(144, 1) == 1.5);
  CHECK(panel_scale(192, 2) == 1);
  CHECK(panel_scale(288, 2) == 1.5);
  CHECK(panel_scale(96, 2) == 1);
  for (const double nonsense : {0.0, 20.0, 5000.0, std::numeric_limits<double>::quiet_NaN()})
    CHECK(panel_scale(nonsense, 1) == 1);
}
