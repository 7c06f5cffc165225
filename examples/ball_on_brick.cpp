// A world of ours, without an engine: a steel ball falls on bricks; what happened in two seconds.
#include <intaglio/world.h>

#include <iostream>

int main() {
  const auto wall = intaglio::Surface::load("brick", {.size = {4, 4}}).value();
  auto world = intaglio::World::create({.floor = wall}).value();
  const auto ball = world.add(intaglio::Sphere{0.05}, {.material = "steel", .position = {0, 1, 0}});
  if (!ball) {
    std::cerr << ball.error() << '\n';
    return 1;
  }
  world.run(2.0);
  for (const intaglio::ContactEvent& e : world.events())
    if (e.phase == intaglio::ContactPhase::begin)
      std::cout << e.time << " s  " << e.point.transpose() << "  " << e.impulse.norm() << " N s\n";
  std::cout << "at rest at " << world.pose(*ball).position.transpose() << '\n';
  return world.pose(*ball).position.y() > -0.1 ? 0 : 1;  // on a brick, or between two
}
