// What does a texture say? Loads one, prints what import found, and asks for heights, slopes, a ray and a closest point.
//
//   example_texture_report [TEXTURE]        a folder, an image, or a built-in name; "brick" by default
#include <intaglio/surface.h>

#include <iostream>

int main(int argc, char** argv) {
  const auto wall = intaglio::Surface::load(argc > 1 ? argv[1] : "brick", {.size = {4, 4}});
  if (!wall) {
    std::cerr << wall.error() << '\n';
    return 1;
  }
  if (!wall->import_report().empty()) std::cout << wall->import_report() << '\n';
  std::cout << wall->texels_u() << " x " << wall->texels_v() << " texels, " << 1000 * wall->depth() << " mm deep\n";
  std::cout << "height at (0.25, 0.5): " << wall->height({0.25, 0.5}) << " m\n";
  std::cout << "slope, averaged over 1 cm: " << wall->slope({0.25, 0.5}, 0.01).transpose() << '\n';

  if (const auto hit = wall->ray({0, 1, 0}, {0.3, -1, 0.1}))
    std::cout << "a ray hits at " << hit->point.transpose() << ", uv " << hit->uv.transpose() << '\n';
  const auto near = wall->closest({0.2, 0.01, 0.4});
  std::cout << "the closest point is " << near->distance << " m away, normal " << near->normal.transpose() << '\n';
}
