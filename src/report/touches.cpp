#include "report/touches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace intaglio::report {

namespace {

constexpr double masking_time = 0.1;      // s
constexpr double masking_fraction = 0.5;  // of an impulse: what masks it is stronger
constexpr double audible_fraction = 0.1;  // of the body's strongest

// Whether `a` stands and `b`, which is near it, does not.
bool beats(const AudibleTouch& a, const AudibleTouch& b) {
  return a.impulse > b.impulse || (a.impulse == b.impulse && a.time < b.time);
}

}  // namespace

void TouchFinder::add(const ContactEvent& event) {
  const bool is_sound = std::isfinite(event.time) && std::isfinite(event.duration) &&
                        event.impulse.allFinite() && event.time >= 0;
  if (!is_sound) return;
  const std::pair bodies(event.body, event.other);
  Pair& pair = pairs_[bodies];
  if (pair.points.empty() || event.time - pair.time > 1e-3 * event.duration) {
    close_step(bodies, pair);
    pair.time = event.time;
    pair.duration = event.duration;
  }
  pair.impulse += event.impulse;
  pair.points.push_back({event.time - event.touch_age, event.impulse.norm()});
}

void TouchFinder::close_step(const std::pair<BodyId, BodyId>& bodies, Pair& pair) {
  if (pair.points.empty()) return;
  // The earliest touch among points that carry at least a third of the step's impulse.
  double touched = std::numeric_limits<double>::infinity();
  for (const Point& point : pair.points)
    if (std::isfinite(point.touch) && point.impulse >= pair.impulse.norm() / 3)
      touched = std::min(touched, point.touch);
  if (std::isinf(touched)) touched = pair.time - 0.5 * pair.duration;
  if (pair.time - pair.last > 1.5 * pair.duration) pair.splitter.split(Vec3::Zero());
  pair.last = pair.time;
  // A touch may be dated back into the step before.
  settle(pair, pair.time - 2 * pair.duration - AudibleTouch::merge_window);
  if (const double impulse = pair.splitter.split(pair.impulse).norm(); impulse > 0) {
    Blow blow{{touched, bodies.first, bodies.second, impulse}};
    for (Blow& near : pair.blows) {
      if (std::abs(near.touch.time - touched) > AudibleTouch::merge_window) continue;
      near.is_weaker |= beats(blow.touch, near.touch);
      blow.is_weaker |= beats(near.touch, blow.touch);
    }
    pair.blows.push_back(blow);
  }
  pair.impulse = Vec3::Zero();
  pair.points.clear();
}

// Keeps the blows before `time` that are the strongest of their windows.
void TouchFinder::settle(Pair& pair, double time) {
  const auto is_strong_now = [this](const AudibleTouch& touch) { return is_strong(touch); };
  std::erase_if(pair.blows, [&](const Blow& blow) {
    if (blow.touch.time >= time) return false;
    if (!blow.is_weaker) {
      double& strongest = strongest_[blow.touch.body];
      strongest = std::max(strongest, blow.touch.impulse);
      if (is_strong(blow.touch)) touches_.add(blow.touch, is_strong_now);
    }
    return true;
  });
}

bool TouchFinder::is_strong(const AudibleTouch& touch) const {
  return touch.impulse >= AudibleTouch::min_fraction * strongest_.at(touch.body);
}

void TouchFinder::finish() {
  for (auto& [bodies, pair] : pairs_) {
    close_step(bodies, pair);
    settle(pair, std::numeric_limits<double>::infinity());
  }
}

std::vector<AudibleTouch> TouchFinder::touches(std::size_t stride) const {
  TimeSample<AudibleTouch> sample = touches_;
  sample.thin(stride);
  std::vector<AudibleTouch> out = sample.kept();
  std::erase_if(out, [this](const AudibleTouch& touch) { return !is_strong(touch); });
  std::stable_sort(out.begin(), out.end(), [](const AudibleTouch& a, const AudibleTouch& b) {
    return std::tie(a.time, a.body, a.other) < std::tie(b.time, b.body, b.other);
  });
  return out;
}

std::vector<AudibleTouch> unmasked(std::span<const AudibleTouch> touches) {
  std::map<BodyId, double> most;
  for (const AudibleTouch& touch : touches) most[touch.body] = std::max(most[touch.body], touch.impulse);
  std::vector<AudibleTouch> out;
  for (std::size_t k = 0; k < touches.size(); ++k) {
    bool stands = touches[k].impulse >= audible_fraction * most[touches[k].body];
    for (std::size_t i = k; stands && i-- > 0 && touches[k].time - touches[i].time < masking_time;)
      stands = touches[i].impulse <= masking_fraction * touches[k].impulse;
    if (stands) out.push_back(touches[k]);
  }
  return out;
}

}  // namespace intaglio::report
