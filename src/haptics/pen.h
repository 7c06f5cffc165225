// The pen in the hand, and the data that scene and servo loop exchange about it.
//
// Snapshots and reports are plain values, copied through latest-value slots (core/lock_free.h). The loop runs
// several ticks on one snapshot and extrapolates bodies with constant velocity. Reactions are sums since the
// start, so that nothing is lost when the scene reads only every tenth report.
#pragma once

#include <array>
#include <cstddef>

#include "haptics/guard.h"
#include "haptics/proxy.h"
#include "intaglio/event.h"
#include "intaglio/vec.h"

namespace intaglio::haptics {

inline constexpr std::size_t max_balls = 32;

// World frame, SI.
struct BodyMotion {
  Pose pose;                             // of the surface, relative to its placement
  Vec3 velocity = Vec3::Zero();          // m/s, of pose.position
  Vec3 angular_velocity = Vec3::Zero();  // rad/s

  // The pose `seconds` after the snapshot.
  Pose extrapolated(double seconds) const {
    return {pose.position + seconds * velocity, rotation(seconds * angular_velocity) * pose.orientation};
  }
};

struct SceneBall {
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
  double radius = 0;
};

struct SceneSnapshot {
  double time = 0;      // s on the loop's clock, when it was taken
  BodyMotion textured;  // the body that carries the surface
  std::array<SceneBall, max_balls> balls;
  std::size_t ball_count = 0;
};

struct ServoReport {
  ServoReport() { ball_impulse.fill(Vec3::Zero()); }

  double time = 0;
  Vec3 tip = Vec3::Zero(), proxy = Vec3::Zero();  // m, world
  Vec3 force = Vec3::Zero();                      // N, world: of the contact
  Vec3 felt = Vec3::Zero();      // N, as sent: `force`, unless the hand is given another (set_contact)
  Vec3 velocity = Vec3::Zero();  // m/s of the tip, filtered, relative to the textured body
  bool touching = false;
  std::uint32_t guard_status = 0;
  std::size_t ticks = 0;
  std::array<Vec3, max_balls> ball_impulse{};    // N s on each ball since the start, world
  Vec3 textured_impulse = Vec3::Zero();          // N s on the textured body since the start
  Vec3 textured_angular_impulse = Vec3::Zero();  // N m s about its pose's position
};

// A tip, a shaft, a grip.
struct PenShape {
  double length = 0.15;                  // m, tip to end
  double radius = 0.005;                 // m, of the shaft
  double tip_radius = 0.001;             // m: the tip feels the relief averaged over its diameter
  double grip = 0.06;                    // m from the tip: the reference point of torque
  double taper = 0.02;                   // m from the tip, from which on the shaft collides with the texture
  double shaft_stiffness = 0;            // N/m per metre of shaft, against the texture; 0: tip only
  Vec3 direction = Vec3(0.25, 1, 0.35);  // from the tip up the shaft, for devices without orientation
};

// In any frame.
struct PenPose {
  Vec3 tip = Vec3::Zero();
  Vec3 up = Vec3::UnitY();  // unit, from the tip to the end

  Vec3 at(double s) const { return tip + s * up; }
};

// The wrench, about the grip and in the solid's frame, of a shaft pressed into a solid: the exact derivative
// of shaft_energy() with respect to the pen's position and rotation. At most 16 samples of the solid: 1 us on
// a slab.
Wrench shaft_wrench(const Solid& solid, const PenShape& shape, const PenPose& pose);
// The potential of that wrench, J: 1/2 k (depth + radius)^2 per metre of shaft, by 16 Gauss points. For
// tests.
double shaft_energy(const Solid& solid, const PenShape& shape, const PenPose& pose);

// The pen (a capsule) against a ball: a damped spring along the shortest line that never pulls. World frame.
struct BallContact {
  bool touching = false;
  Vec3 force = Vec3::Zero();  // N, on the pen; its opposite acts on the ball
  Vec3 point = Vec3::Zero();  // m, on the pen's axis
};
BallContact touch_ball(const PenShape& shape, const PenPose& pose, const Vec3& tip_velocity,
                       const SceneBall& ball, double stiffness, double damping);

}  // namespace intaglio::haptics
