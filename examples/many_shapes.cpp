// Bodies of every kind in one world: box, capsule, hull, a concave mesh's compound stand-in, and a carved ball.
#include <intaglio/solid.h>
#include <intaglio/world.h>

#include <iostream>
#include <vector>

using namespace intaglio;

int main() {
  const auto floor = Surface::load("pebbles", {.size = {3, 3}});
  const auto carved = CurvedSurface::load("pebbles", repeated(sphere_mesh(0.12), {2, 1}), {.depth = 0.004});
  const auto hull = make_hull(std::vector<Vec3>{{0.1, 0, 0}, {-0.1, 0, 0}, {0, 0.1, 0}, {0, -0.1, 0}, {0, 0, 0.1}, {0, 0, -0.1}});
  if (!floor || !carved || !hull) {
    std::cerr << (!floor ? floor.error() : !carved ? carved.error() : hull.error()) << '\n';
    return 1;
  }
  const Compound dumb_bell = make_compound({{Sphere{0.07}, {Vec3(-0.12, 0, 0)}}, {Sphere{0.07}, {Vec3(0.12, 0, 0)}}});

  auto world = World::create({.floor = *floor}).value();
  std::vector<Result<BodyId>> bodies = {
      world.add(Box{{0.1, 0.05, 0.08}}, {.material = "wood", .position = {-1, 0.4, 0}}),
      world.add(Capsule{0.05, 0.1}, {.material = "plastic", .position = {-0.5, 0.4, 0}}),
      world.add(*hull, {.material = "stone", .position = {0, 0.4, 0}}),
      world.add(dumb_bell, {.material = "iron", .position = {0.5, 0.4, 0}}),
      world.add(Sphere{0.12}, {.material = "stone", .position = {1, 0.4, 0}, .skin = *carved})};
  world.run(1.5);
  for (const auto& body : bodies) {
    if (!body) {
      std::cerr << body.error() << '\n';
      return 1;
    }
    std::cout << "body " << *body << ": " << world.pose(*body).position.transpose() << '\n';
    if (world.pose(*body).position.y() < -0.1) return 1;
  }
}
