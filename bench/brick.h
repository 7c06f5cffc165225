// Shared by several benchmarks: the built-in brick at any size, and a clock.
#pragma once

#include <time.h>

#include <algorithm>

#include "surface/import.h"
#include "surface/surface.h"

namespace intaglio::bench {

// CPU time of the thread.
inline double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

inline surface::Texels upsampled(const surface::Surface& from, int size) {
  surface::Texels out;
  out.width = out.height = size;
  out.depth.reserve(std::size_t(size) * std::size_t(size));
  out.normal.reserve(out.depth.capacity());
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      const surface::Smooth s = from.smooth({(i + 0.5) / size, (j + 0.5) / size});
      out.depth.push_back(float(std::clamp(-s.height / from.max_depth(), 0.0, 1.0)));
      out.normal.push_back(Vec3(-s.gradient.x(), -s.gradient.y(), 1).normalized());
    }
  }
  out.colour = Image8(1, 1, 3);
  return out;
}

// A square of `side` metres, 2 % deep. Above 1024 texels a side bicubically upsampled from there: the brick's
// noise ends at 192 waves a side, so nothing is missing.
inline surface::Surface brick(int size, double side = 1) {
  const surface::Placement placement(Vec3::Zero(), Quat::Identity(), side, side);
  surface::BrickRecipe recipe;
  recipe.size = std::min(size, 1024);
  surface::Surface generated(surface::to_texels(surface::make_brick(recipe)), placement, 0.02 * side,
                             surface::Edge::wrap);
  if (size <= 1024) return generated;
  return {upsampled(generated, size), placement, 0.02 * side, surface::Edge::wrap};
}

}  // namespace intaglio::bench
