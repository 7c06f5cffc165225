// What a live session is told and what it shows: plain values that cross between the window's thread and the
// physics thread in latest-value slots (core/latest.h). World frame, SI.
#pragma once

#include <array>
#include <cstdint>

#include "intaglio/core/event.h"
#include "intaglio/haptics/scene_snapshot.h"

namespace intaglio::session {

inline constexpr std::size_t most_live_bodies = 256, most_marks = 64;

struct Controls {
  bool paused = false;
  double speed = 1;             // simulated seconds a second, 0.01..1
  std::uint64_t single = 0;     // steps asked for since the start, while paused
  std::uint64_t resets = 0;     // asked for since the start
  unsigned keys = 0;            // left_key, right_key of scene_world.h
  BodyId dragged = floor_body;  // the floor: none
  Vec3 grip = Vec3::Zero();     // where it is held, in the body's frame
  Vec3 pull_to = Vec3::Zero();  // m, where that point is wanted
};

// One contact of one step, to be drawn until it fades.
struct ContactMark {
  double time = 0;
  BodyId body = 0, other = floor_body;
  bool begins = false;
  Vec3 point = Vec3::Zero(), n_g = Vec3::UnitY(), n_s = Vec3::UnitY(), impulse = Vec3::Zero();
  Vec2 uv = Vec2::Zero();
};

struct LiveState {
  double time = 0;          // s, simulated
  std::uint64_t steps = 0;  // physics steps
  std::uint64_t late = 0;   // steps left out because the machine did not keep up
  double step_seconds = 0;  // CPU time of a step, smoothed
  std::size_t bodies = 0;   // balls, then the scene's other bodies
  std::array<Pose, most_live_bodies> pose;
  std::uint64_t marks = 0;  // since the start; the newest is at (marks - 1) % most_marks
  std::array<ContactMark, most_marks> mark;
  haptics::ServoReport pen;
};

}  // namespace intaglio::session
