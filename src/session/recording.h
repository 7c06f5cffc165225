// The result of a session: everything that the report draws and the logs hold. SI units.
#pragma once

#include <time.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "haptics/servo.h"
#include "intaglio/event.h"
#include "intaglio/image.h"
#include "intaglio/representation.h"
#include "scene/voices/voices.h"
#include "surface/surface.h"

namespace intaglio::session {

struct BallTrack {
  BodyId body = 0;
  double radius = 0;           // m
  std::vector<Vec3> position;  // m, one per physics step, the first at time 1 / physics_rate
};

struct KeyFrame {
  double time = 0;  // s
  Image8 image;     // RGB, row 0 = top
};

// The cost of one sense, thread-CPU time.
struct SenseCost {
  std::string sense;        // "dynamics", "haptics", "sound", "picture"
  std::string step;         // "1/480 s step", "64-sample block", "640x360 frame"
  double step_seconds = 0;  // simulated time per step
  std::size_t steps = 0;
  double median_us = 0;
  double p99_us = 0;
  double total_s = 0;
};

struct Recording {
  std::string title;
  double duration = 0;                                                       // s
  int physics_rate = 480, servo_rate = 1000, sample_rate = 44100, fps = 30;  // Hz
  Representation representation = Representation::relief;
  std::shared_ptr<const surface::Surface> surface;
  std::string texture;             // as the scene names it
  std::vector<std::string> notes;  // import notes, one per line

  std::vector<std::string> warnings;  // what the scene asks of a device beyond its abilities, one per line

  std::vector<BallTrack> balls;
  std::vector<haptics::ServoSample> servo;  // one per tick, the first at time 0; empty without a pen
  BodyId pen = 0;                           // 0: no pen
  std::vector<ContactEvent> events;         // in order of time
  std::vector<float> stereo;                // -1..1, interleaved, at the camera
  std::vector<float> audio;                 // the mean of both sides
  std::vector<KeyFrame> key_frames;
  std::vector<scene::Voice> voices;

  std::vector<SenseCost> costs;
  double bake_s = 0;             // CPU time of the modal analysis
  double wall_s = 0;             // of the whole run
  double momentum_residual = 0;  // N s, dynamics::World::momentum_residual()
  std::size_t surface_bytes = 0;
  std::size_t peak_memory_bytes = 0;  // resident, of the process
  std::uint64_t event_hash = 0;
  std::uint64_t audio_hash = 0;
};

// CPU time in nanoseconds: of a POSIX clock (pthread_getcpuclockid), the calling thread, the process.
std::int64_t cpu_ns(clockid_t clock);
std::int64_t thread_cpu_ns();
std::int64_t process_cpu_ns();
// Largest resident size of the process so far, bytes.
std::size_t peak_memory_bytes();

// Collects the cost of one sense's steps, in CPU time, so that other load does not count. One meter per
// thread.
class CostMeter {
 public:
  // Runs step() and records its cost.
  template <class Step>
  void measure(Step&& step) {
    const std::int64_t start = thread_cpu_ns();
    step();
    ns_.push_back(thread_cpu_ns() - start);
  }
  void add(std::int64_t ns) { ns_.push_back(ns); }

  // Fills steps, median, p99 and total of `cost`.
  SenseCost summarise(SenseCost cost) const;

 private:
  std::vector<std::int64_t> ns_;
};

// Event and servo logs as CSV: one header line, SI units in the column names, numbers with all their digits.
std::string events_csv(const Recording& recording);
std::string servo_csv(const Recording& recording);

}  // namespace intaglio::session
