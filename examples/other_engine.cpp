// Contacts as values, for a physics engine of any make: a box lowered onto bricks.
#include <intaglio/contact.h>

#include <iostream>

int main() {
  const auto wall = intaglio::Surface::load("brick", {.size = {4, 4}});
  if (!wall) {
    std::cerr << wall.error() << '\n';
    return 1;
  }
  const intaglio::Box box{{0.1, 0.1, 0.1}};
  intaglio::Pose pose;
  for (const double height : {0.12, 0.1, 0.09}) {
    pose.position.y() = height;
    const intaglio::ContactSet touching = intaglio::contacts(*wall, box, pose, {.margin = 0.05});
    std::cout << "centre at " << height << " m: " << touching.size() << " contacts\n";
    for (const intaglio::ContactPoint& c : touching)  // my_engine.add(c.point, c.normal, c.distance, c.feature)
      std::cout << "  " << c.point.transpose() << "  normal " << c.normal.transpose() << "  gap " << c.distance << '\n';
    if (touching.empty()) return 1;
  }
}
