// What is in a scene file?
//
//   example_scene_info SCENE.toml
#include <intaglio/scene.h>

#include <iostream>

int main(int argc, char** argv) {
  const auto scene = argc > 1 ? intaglio::Scene::load(argv[1]) : intaglio::Scene::parse("[surface]\n", "built in");
  if (!scene) {
    std::cerr << scene.error() << '\n';
    return 1;
  }
  std::cout << scene->title() << ": " << scene->duration() << " s, " << scene->body_count() << " bodies"
            << (scene->has_pen() ? ", a pen\n" : "\n");
}
