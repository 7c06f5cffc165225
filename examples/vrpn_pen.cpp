// A device at the other end of a VRPN link, on bricks. `intaglio devices serve` serves a simulated one.
//
//   example_vrpn_pen NAME@HOST
#include <intaglio/vrpn.h>

#include <chrono>
#include <iostream>
#include <thread>

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cout << "usage: example_vrpn_pen NAME@HOST\n";
    return 0;
  }
  const auto pen = intaglio::open_vrpn(argv[1]);
  if (!pen) {
    std::cerr << pen.error() << '\n';
    return 1;
  }
  const auto wall = intaglio::Surface::load("brick", {.size = {0.2, 0.2}, .depth = 0.002}).value();
  auto touch = intaglio::ServoLoop::create(*pen, {.surface = wall, .stiffness = 600}).value();
  touch.start();
  for (int k = 0; k < 1000; ++k) {
    touch.publish();  // also the heartbeat: 20 ms without one and the guard lets go
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (k % 100 == 0) std::cout << "force " << touch.report().force.transpose() << '\n';
  }
  std::cout << touch.timing().priority << '\n';
}
