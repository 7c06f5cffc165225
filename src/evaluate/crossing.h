// One probe that crosses the relief, and what each sense delivers of it: a pen in a hand, or a ball.
//
// Everything in a crossing is a sense's own output: where the probe is drawn, the force at the hand, the
// ball's motion, the samples of sound. Pictures are seen separately (evaluate/sight.h). SI units; local
// coordinates of the surface. Deterministic; seconds of CPU at most; any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "evaluate/subject.h"

namespace intaglio::evaluate {

enum class Probe { pen, ball };

struct Crossing {
  Probe probe = Probe::pen;
  bool is_strike = false;  // a ball that is dropped
  double radius = 0;       // m, of tip or ball
  double rate = 0;         // Hz, of the series; their first value is at `start`
  double start = 0;        // s
  // m, of the tip or the ball's lowest point, as drawn; a series.
  std::vector<Vec3> place = {};
  std::vector<Vec3> force = {};  // N on the hand, local axes (t, b, n); pens only
  std::vector<bool> touching = {};
  std::vector<Vec3> acceleration =
      {};                         // m/s^2, local, mean over the step that ends at the value's time; balls
  double sample_rate = 44100;     // Hz
  std::vector<float> sound = {};  // Pa at 1 m, the first sample at time 0

  // m, local, of a candidate's ball: how far it is from the reference's when it has run on its own for
  // RollOptions::restart seconds.
  std::vector<Vec3> strayed = {};

  // CPU seconds of each step.
  double touch_cost = 0, motion_cost = 0, sound_cost = 0;

  double time(std::size_t k) const { return start + double(k) / rate; }
};

struct StrokeOptions {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();  // m, local, of the hand
  double speed = 0.15;                          // m/s
  double load = 1;                              // N downwards
};
// A hand (led_hand.h) that strokes along a line; servo at 1 kHz.
Crossing stroke(const Subject& subject, const Candidate& candidate, const StrokeOptions& options);
// The same hand on the reference.
Crossing reference_stroke(const Subject& subject, const StrokeOptions& options);

// Work of the texture on a hand that is led round a circle, once a second, at constant height: J a round, the
// mean of four. A surface that gives energy (above 0) feels alive; friction takes some.
double loop_energy(const Subject& subject, const Candidate& candidate, const Vec2& centre, double radius);

struct RollOptions {
  Vec2 from = Vec2::Zero();      // m, local
  Vec2 velocity = Vec2::Zero();  // m/s
  double seconds = 1;
  double restart = 0.1;  // s, after which a candidate's ball starts again from the reference's state
  double drop = 0;       // m above the relief at which it starts
};
// A ball on the reference that is set down rolling, or dropped, and the state after every 1 /
// reference_rate s; no
// sound.
struct ReferenceRoll {
  Crossing crossing;
  std::vector<BodyState> states;  // local, from the start on
};
ReferenceRoll reference_roll(const Subject& subject, const RollOptions& options);
// A candidate's ball, physics at 480 Hz. Rolling over a relief is chaotic: two exact engines part within a
// second. So the ball starts again from the reference's state every `restart` seconds.
Crossing roll(const Subject& subject, const Candidate& candidate, const RollOptions& options,
              const ReferenceRoll& reference);

}  // namespace intaglio::evaluate
