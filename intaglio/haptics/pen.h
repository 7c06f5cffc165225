// The pen in the hand: a tip, a shaft, a grip; and the wrench of what touches the shaft.
#pragma once

#include <array>

#include "intaglio/haptics/scene_snapshot.h"
#include "intaglio/haptics/solid.h"
#include "intaglio/haptics/wrench.h"

namespace intaglio::haptics {

struct PenShape {
  double length = 0.15;                  // m, tip to end
  double radius = 0.005;                 // m, of the shaft
  double tip_radius = 0.001;             // m: the tip feels the relief averaged over its diameter
  double grip = 0.06;                    // m from the tip: torque is about there
  double taper = 0.02;                   // m from the tip, where the shaft begins to collide with the texture
  double shaft_stiffness = 0;            // N/m a metre of shaft, against the texture; 0: only the tip touches
  Vec3 direction = Vec3(0.25, 1, 0.35);  // from the tip up the shaft, where the device tells no orientation
};

// Where the pen is. Any frame.
struct PenPose {
  Vec3 tip = Vec3::Zero();
  Vec3 up = Vec3::UnitY();  // unit, from the tip to the end

  Vec3 at(double s) const { return tip + s * up; }
};

// The line of the shaft pressed into a solid: the energy 1/2 k (depth + radius)^2 a metre, integrated by 16
// Gauss points, and its exact derivative with respect to the pen's position and rotation. Wrench about the
// grip, frame of the solid. 16 samples of the solid at most: 1 us on a slab.
Wrench shaft_wrench(const Solid& solid, const PenShape& shape, const PenPose& pose);
double shaft_energy(const Solid& solid, const PenShape& shape, const PenPose& pose);

// Pen (a capsule) against a ball: a spring along the shortest line, damped, never pulling. World frame.
struct BallContact {
  bool touching = false;
  Vec3 force = Vec3::Zero();  // N, on the pen; the ball gets the opposite
  Vec3 point = Vec3::Zero();  // m, on the pen's axis
};
BallContact touch_ball(const PenShape& shape, const PenPose& pose, const Vec3& tip_velocity,
                       const SceneBall& ball, double stiffness, double damping);

}  // namespace intaglio::haptics
