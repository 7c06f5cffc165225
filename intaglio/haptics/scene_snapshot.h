// What the scene tells the servo loop, and what the loop tells the scene: plain values, copied through
// latest-value slots (core/latest.h).
//
// The loop runs several ticks on one snapshot: bodies go on moving as they did when it was taken. Reactions
// are sums since the start, so that nothing is lost when the scene reads only every tenth of them.
#pragma once

#include <array>
#include <cstddef>

#include "intaglio/core/event.h"
#include "intaglio/core/rotation.h"
#include "intaglio/core/vec.h"

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
  bool touching = false;
  std::uint32_t guard_status = 0;
  std::size_t ticks = 0;
  std::array<Vec3, most_balls> ball_impulse{};   // N s on each ball since the start, world
  Vec3 textured_impulse = Vec3::Zero();          // N s on the textured body since the start
  Vec3 textured_angular_impulse = Vec3::Zero();  // N m s about its pose's position
};

}  // namespace intaglio::haptics
