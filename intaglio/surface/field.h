// Plain fields on the texel grid, as import works with them: row 0 = bottom (v = 0), texels square.
#pragma once

#include <cstddef>
#include <vector>

namespace intaglio::surface {

struct Field {
  int width = 0;
  int height = 0;
  std::vector<float> value;  // height x width

  Field() = default;
  Field(int w, int h) : width(w), height(h), value(std::size_t(w) * std::size_t(h)) {}

  bool empty() const { return value.empty(); }
  float& at(int x, int y) { return value[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
  float at(int x, int y) const { return value[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

// Slopes of the height: dz/dx along u and dz/dy along v (up the image), both dimensionless.
struct Slopes {
  Field x, y;

  bool empty() const { return x.empty(); }
};

}  // namespace intaglio::surface
