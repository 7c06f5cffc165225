// A unit normal in four bytes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "intaglio/core/vec.h"

namespace intaglio::surface {

// A unit normal, n_z >= 0, in 4 bytes.
struct PackedNormal {
  std::int16_t x, y;  // times 32767

  static PackedNormal pack(const Vec3& normal);
  Vec3 unit() const {
    const double nx = x / 32767.0;
    const double ny = y / 32767.0;
    return {nx, ny, std::sqrt(std::max(0.0, 1.0 - nx * nx - ny * ny))};
  }
};

}  // namespace intaglio::surface
