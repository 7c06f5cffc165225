#include "intaglio/contact/leaf_walk.h"

namespace intaglio::contact {

Leaf::Leaf(const surface::Surface& surface, int first_i, int first_j)
    : i(first_i),
      j(first_j),
      begin_c(std::max(0, -i)),
      end_c(std::min(side, surface.width() - i)),
      last_c(std::min(side, surface.width() - 1 - i)),
      begin_r(std::max(0, -j)),
      end_r(std::min(side, surface.height() - j)),
      last_r(std::min(side, surface.height() - 1 - j)),
      w(surface.texel_u()),
      h(surface.texel_v()) {
  for (int r = -1; r <= side; ++r) {
    for (int c = -1; c <= side; ++c) {
      const bool there = i + c >= 0 && i + c < surface.width() && j + r >= 0 && j + r < surface.height();
      z[std::size_t(r + 1)][std::size_t(c + 1)] = there ? surface.texel_z(i + c, j + r) : nowhere;
    }
  }
}

}  // namespace intaglio::contact
