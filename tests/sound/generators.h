// Random numbers and vectors of RapidCheck, for the tests of sound.
#pragma once

#include <rapidcheck.h>

#include "intaglio/vec.h"

namespace intaglio::sound::test {

inline double any_number(double low, double high) {
  return low + (high - low) * double(*rc::gen::inRange(0, 1 << 20)) / (1 << 20);
}

// Each coordinate in -size..size.
inline Vec3 any_vector(double size) {
  return {any_number(-size, size), any_number(-size, size), any_number(-size, size)};
}

}  // namespace intaglio::sound::test
