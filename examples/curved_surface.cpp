// A texture on a curved base: pebbles in a bowl, and how far points are from them.
//
//   example_curved_surface [MESH]        .obj, .gltf or .glb with texture coordinates; a bowl by default
#include <intaglio/mesh.h>

#include <iostream>

int main(int argc, char** argv) {
  auto mesh = argc > 1 ? intaglio::load_mesh(argv[1]) : intaglio::bowl_mesh(0.5);
  if (!mesh) {
    std::cerr << mesh.error() << '\n';
    return 1;
  }
  const auto bowl = intaglio::CurvedSurface::load("pebbles", repeated(std::move(*mesh), {4, 1}), {.depth = 0.01});
  if (!bowl) {
    std::cerr << bowl.error() << '\n';
    return 1;
  }
  std::cout << bowl->mesh().triangles.size() << " triangles; relief may be " << bowl->fold_depth() << " m deep\n";
  const intaglio::Vec3 p = bowl->low() + intaglio::Vec3(0.5, 0.05, 0.5);
  if (const auto near = bowl->closest(p, 1))
    std::cout << "from " << p.transpose() << " it is " << near->distance << " m to " << near->point.transpose() << '\n';
}
