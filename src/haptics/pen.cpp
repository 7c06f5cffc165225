#include "haptics/pen.h"

#include <algorithm>

namespace intaglio::haptics {

namespace {

// Gauss-Legendre nodes and weights: 8 points on -1..1 (symmetric), for each of two panels of the shaft.
constexpr std::array<double, 4> node = {0.18343464249564980494, 0.52553240991632898582,
                                        0.79666647741362673959, 0.96028985649753623168};
constexpr std::array<double, 4> weight = {0.36268378337836198297, 0.31370664587788728734,
                                          0.22238103445337447054, 0.10122853629037625915};

// Calls visit(s, ds) at the nodes along the shaft.
template <class Visit>
void integrate(const PenShape& shape, const Visit& visit) {
  const double half = 0.25 * (shape.length - shape.taper);
  for (int panel = 0; panel < 2; ++panel) {
    const double middle = shape.taper + (2 * panel + 1) * half;
    for (std::size_t k = 0; k < node.size(); ++k) {
      visit(middle - half * node[k], half * weight[k]);
      visit(middle + half * node[k], half * weight[k]);
    }
  }
}

}  // namespace

Wrench shaft_wrench(const Solid& solid, const PenShape& shape, const PenPose& pose) {
  Wrench sum;
  integrate(shape, [&](double s, double ds) {
    const Vec3 q = pose.at(s);
    const Penetration p = solid.at(q);
    const double depth = p.depth + shape.radius;
    if (depth <= 0) return;
    sum += Wrench::of(-shape.shaft_stiffness * ds * depth * p.gradient, q, pose.at(shape.grip));
  });
  return sum;
}

double shaft_energy(const Solid& solid, const PenShape& shape, const PenPose& pose) {
  double sum = 0;
  integrate(shape, [&](double s, double ds) {
    const double depth = std::max(0.0, solid.at(pose.at(s)).depth + shape.radius);
    sum += 0.5 * shape.shaft_stiffness * ds * depth * depth;
  });
  return sum;
}

BallContact touch_ball(const PenShape& shape, const PenPose& pose, const Vec3& tip_velocity,
                       const SceneBall& ball, double stiffness, double damping) {
  const double s = std::clamp(pose.up.dot(ball.position - pose.tip), 0.0, shape.length);
  BallContact contact;
  contact.point = pose.at(s);
  const Vec3 away = contact.point - ball.position;
  const double distance = away.norm();
  // The radius grows from the tip's to the shaft's over the taper.
  const double radius =
      shape.tip_radius + (shape.radius - shape.tip_radius) * std::min(1.0, s / std::max(shape.taper, 1e-9));
  const double depth = ball.radius + radius - distance;
  if (depth <= 0 || distance < 1e-9) return contact;
  const Vec3 n = away / distance;
  contact.touching = true;
  contact.force = std::max(0.0, stiffness * depth - damping * n.dot(tip_velocity - ball.velocity)) * n;
  return contact;
}

}  // namespace intaglio::haptics
