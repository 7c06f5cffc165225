// A picture without a screen: bricks, and a ball on them.
//
//   example_picture [PICTURE.png]
#include <intaglio/render.h>

#include <iostream>

int main(int argc, char** argv) {
  const auto wall = intaglio::Surface::load("brick", {.size = {4, 4}});
  auto renderer = intaglio::Renderer::headless(480, 270);
  if (!wall || !renderer) {
    std::cerr << (!wall ? wall.error() : renderer.error()) << '\n';
    return 1;
  }
  const auto picture = renderer->draw({.surfaces = {*wall},
                                       .balls = {{.pose = {{0, 0.2, 0}}, .radius = 0.2}},
                                       .camera = {.eye = {0, 1, 2}}});
  const auto saved = picture ? picture->save(argc > 1 ? argv[1] : "wall.png") : tl::unexpected(picture.error());
  if (!saved) {
    std::cerr << saved.error() << '\n';
    return 1;
  }
}
