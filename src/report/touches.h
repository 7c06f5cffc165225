// Audible touches: contacts that begin, and edges struck while sliding or rolling.
//
// During sustained contact only the increase of a step's impulse counts as a touch (sound/contact_step.h).
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "intaglio/event.h"
#include "report/bounded.h"
#include "sound/contact_step.h"

namespace intaglio::report {

struct AudibleTouch {
  // s; touches of one pair closer than this are merged, keeping the strongest.
  static constexpr double merge_window = 0.005;
  // Least impulse, as a fraction of the body's strongest: light bodies strike as bright as heavy ones.
  static constexpr double min_fraction = 0.02;

  double time = 0;     // s, of the touch where it is known, otherwise the middle of its step
  BodyId body = 0;     // the touching body
  BodyId other = 0;    // what it touches
  double impulse = 0;  // N s, the increase
};

class TouchFinder {
 public:
  // Those of one pair in order of time.
  void add(const ContactEvent& event);
  // After the last event.
  void finish();

  // In order of time, all at least `min_fraction` of their body's strongest; where there are many, those in
  // every `stride`th window of a TimeSample, a multiple of stride().
  std::vector<AudibleTouch> touches(std::size_t stride) const;
  std::size_t stride() const { return touches_.stride(); }

 private:
  struct Point {
    double touch;  // s; NaN: not known
    double impulse;
  };
  struct Blow {
    AudibleTouch touch;
    bool is_weaker = false;  // than another in its merge window
  };
  // One pair of bodies. The open step is the last: its points and their sum.
  struct Pair {
    double time = -1, duration = 0, last = -1;  // s, of the open step and the one before
    Vec3 impulse = Vec3::Zero();
    std::vector<Point> points;
    sound::ImpulseSplitter splitter;
    std::vector<Blow> blows;  // whose merge windows are not over yet
  };
  void close_step(const std::pair<BodyId, BodyId>& bodies, Pair& pair);
  void settle(Pair& pair, double time);
  bool is_strong(const AudibleTouch& touch) const;

  std::map<std::pair<BodyId, BodyId>, Pair> pairs_;
  std::map<BodyId, double> strongest_;  // N s, of each body so far
  TimeSample<AudibleTouch> touches_{1 << 15};
};

// Touches that should be audible: at least a tenth of their body's strongest, and at least twice every touch
// in the preceding 100 ms, which would mask them.
std::vector<AudibleTouch> unmasked(std::span<const AudibleTouch> touches);

}  // namespace intaglio::report
