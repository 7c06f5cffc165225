// Receives what a simulation makes, as it makes it: a recording that keeps everything, files that are written
// on the way, the report's digest. So an hour needs no more memory than a minute, except where an observer
// keeps it.
//
// One thread, the simulation's. Each kind comes in order of time; kinds among each other do so only within a
// few steps.
#pragma once

#include <span>

#include "haptics/servo.h"
#include "intaglio/event.h"

namespace intaglio::session {

class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_event(const ContactEvent& /*event*/) {}
  // One servo tick, the first at time 0.
  virtual void on_tick(const haptics::ServoSample& /*sample*/) {}
  // Centres of the balls after a physics step, the first at time 1 / physics_rate. m
  virtual void on_step(std::span<const Vec3> /*balls*/) {}
  // A block at full scale, -1..1, left and right interleaved; any length.
  virtual void on_sound(std::span<const float> /*stereo*/) {}
};

}  // namespace intaglio::session
