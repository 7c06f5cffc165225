// Touch: a simulated hand drags a pen over bricks and pushes a ball. Offline, tick by tick; a real device would run
// touch.start() and publish() at every step of the world instead (haptics.h).
#include <intaglio/haptics.h>
#include <intaglio/world.h>

#include <iostream>

using namespace intaglio;

int main() {
  const auto wall = Surface::load("brick", {.size = {0.2, 0.2}, .depth = 0.002});
  if (!wall) {
    std::cerr << wall.error() << '\n';
    return 1;
  }
  auto world = World::create({.floor = *wall, .step = 1e-3}).value();
  const BodyId ball = world.add(Sphere{0.01}, {.material = "wood", .position = {0.03, 0.0101, 0}}).value();

  const Device pen = Device::simulated({{0, {-0.04, 0.01, 0}}, {0.6, {-0.03, -0.002, 0}}, {2, {0.05, -0.002, 0}}});
  auto touch = ServoLoop::create(pen, {.surface = *wall, .stiffness = 600});
  if (!touch) {
    std::cerr << touch.error() << '\n';
    return 1;
  }
  double hardest = 0;
  for (int k = 0; k < 2000; ++k) {
    world.step();
    const TouchReport now =
        touch->tick({.balls = {{world.pose(ball).position, world.velocity(ball), 0.01}}});
    world.push(ball, touch->take_ball_impulse(0));
    hardest = std::max(hardest, now.force.norm());
    if (k % 200 == 0)
      std::cout << 1e-3 * k << " s  tip " << now.shown_tip.transpose() << "  force " << now.force.transpose() << '\n';
  }
  std::cout << "hardest " << hardest << " N; the ball is at " << world.pose(ball).position.transpose() << '\n';
  return hardest > 0 && hardest < 7.9 && world.pose(ball).position.x() > 0.031 ? 0 : 1;
}
