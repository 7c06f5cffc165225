// A session kept whole: every event, tick, position and sample. SI units.
//
// About 1.5 MB a simulated second with a pen: for programs and tests that look at everything. `intaglio
// render` makes its files and report from the same stream without keeping it (session/result_files.h,
// report/digest.h).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "session/observer.h"
#include "session/run.h"

namespace intaglio::session {

struct Recording : Run, Observer {
  std::vector<std::vector<Vec3>> tracks;    // m, of each ball; one per physics step
  std::vector<haptics::ServoSample> servo;  // one per tick, the first at time 0; empty without a pen
  std::vector<ContactEvent> events;         // in order of time
  std::vector<float> stereo;                // -1..1, interleaved, at the camera
  std::vector<float> audio;                 // the mean of both sides

  void on_event(const ContactEvent& event) override { events.push_back(event); }
  void on_tick(const haptics::ServoSample& sample) override { servo.push_back(sample); }
  void on_step(std::span<const Vec3> balls) override;
  void on_sound(std::span<const float> block) override;

  // Hands everything to an observer, one kind after the other; sound as its mean on both sides.
  void play_back(Observer& observer) const;
};

// The event log as CSV: one header line, SI units in the column names, numbers with all their digits.
std::string events_csv(const Recording& recording);
// Its parts.
extern const std::string_view event_columns;
std::string event_row(const ContactEvent& event);

}  // namespace intaglio::session
