// Contacts as sound is given them: when the cues pen_sound and ball_sound (scene/cues.h) say that they are
// not heard, heard late, or taken from another texture.
//
// The pen's contacts are those of pen_sound, all others of ball_sound. A delay has two parts: what both
// sounds have in common delays the output, to the sample and to the bit; the rest delays the events, by whole
// samples. With true cues events pass through unchanged and nothing is kept. One thread.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "intaglio/event.h"
#include "scene/scene.h"
#include "scene/surfaces.h"

namespace intaglio::session {

struct HeardOptions {
  int sample_rate = 44'100;   // Hz
  double lead = 0;            // s: events are handed on so long before their (delayed) time
  bool delays_output = true;  // false: the whole delay is the events', where the output is another's
};

class HeardContacts {
 public:
  using Sink = std::function<void(const ContactEvent&)>;

  HeardContacts(const scene::Scene& scene, const scene::SceneSurface& surface, const HeardOptions& options);

  // By how much the output is to be delayed.
  std::size_t output_delay() const { return common_; }  // samples

  // Hands the event on, now or by a later release().
  void add(const ContactEvent& event, const Sink& sink);
  // Hands on what is due; `now` is the simulated time that has been reached.
  void release(double now, const Sink& sink);

 private:
  // How one of the two sounds is changed.
  struct Change {
    bool on = true, is_true = true;
    double delay = 0;              // s, of its events
    Vec2 uv_shift = Vec2::Zero();  // of the texture over the floor
    int texture = 0;               // among the floor's, scene/surfaces.h
    std::deque<ContactEvent> waiting;
  };

  double lead_;
  BodyId pen_;  // 0: none
  std::size_t common_ = 0;
  std::array<Change, 2> changes_;  // pen_sound, ball_sound
};

// Delays interleaved stereo by whole samples: what comes out is what went in `samples` before, at first
// silence. Allocates at construction only.
class DelayLine {
 public:
  explicit DelayLine(std::size_t samples) : kept_(2 * samples, 0.0f) {}

  void pass(std::span<float> stereo);

 private:
  std::vector<float> kept_;
  std::size_t next_ = 0;
};

}  // namespace intaglio::session
