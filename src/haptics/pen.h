// What the scene tells the servo loop, and what the loop tells the scene: plain values, copied through
// latest-value slots (core/latest.h).
//
// The loop runs several ticks on one snapshot: bodies go on moving as they did when it was taken. Reactions
// are sums since the start, so that nothing is lost when the scene reads only every tenth of them.
#pragma once

#include <array>
#include <cstddef>

#include "haptics/guard.h"
#include "haptics/proxy.h"
#include "intaglio/event.h"
#include "intaglio/vec.h"

namespace intaglio::haptics {

inline constexpr std::size_t most_balls = 32;

// World frame, SI.
struct BodyMotion {
  Pose pose;                             // moves the surface from where its placement says
  Vec3 velocity = Vec3::Zero();          // m/s, of pose.position
  Vec3 angular_velocity = Vec3::Zero();  // rad/s

  // Where the body is `seconds` after the snapshot.
  Pose after(double seconds) const {
    return {pose.position + seconds * velocity, rotation(seconds * angular_velocity) * pose.orientation};
  }
};

struct SceneBall {
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
  double radius = 0;
};

struct SceneSnapshot {
  double time = 0;      // s, on the loop's clock, when it was taken
  BodyMotion textured;  // the body whose skin is the surface
  std::array<SceneBall, most_balls> balls;
  std::size_t ball_count = 0;
};

struct ServoReport {
  ServoReport() { ball_impulse.fill(Vec3::Zero()); }

  double time = 0;
  Vec3 tip = Vec3::Zero(), proxy = Vec3::Zero(), force = Vec3::Zero();  // world; N as sent
  Vec3 velocity = Vec3::Zero();  // m/s of the tip, filtered, relative to the textured body
  bool touching = false;
  std::uint32_t guard_status = 0;
  std::size_t ticks = 0;
  std::array<Vec3, most_balls> ball_impulse{};   // N s on each ball since the start, world
  Vec3 textured_impulse = Vec3::Zero();          // N s on the textured body since the start
  Vec3 textured_angular_impulse = Vec3::Zero();  // N m s about its pose's position
};

// The pen in the hand: a tip, a shaft, a grip; and the wrench of what touches the shaft.

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
