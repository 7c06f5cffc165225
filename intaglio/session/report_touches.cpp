#include "intaglio/session/report_touches.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "intaglio/sound/contact_force.h"

namespace intaglio::session {

namespace {

constexpr double masks_for = 0.1, masks_from = 0.5, stands_out = 0.1;  // s; of an impulse; of the strongest

// One step of one pair.
struct Step {
  double time = 0, duration = 0;
  Vec3 impulse = Vec3::Zero();
  double touch = 0;
  bool has_touch = false;  // or it is the middle of the step
};

std::map<BodyId, double> strongest(std::span<const Touch> touches) {
  std::map<BodyId, double> most;
  for (const Touch& touch : touches) most[touch.body] = std::max(most[touch.body], touch.impulse);
  return most;
}

std::vector<Step> steps_of(std::span<const ContactEvent* const> events) {
  std::vector<Step> steps;
  for (const ContactEvent* const e : events) {
    if (steps.empty() || e->time - steps.back().time > 1e-3 * e->duration)
      steps.push_back({e->time, e->duration, Vec3::Zero(), e->time - 0.5 * e->duration, false});
    steps.back().impulse += e->impulse;
  }
  // The first touch of those points that bear a third at least.
  for (auto [step, e] = std::pair(steps.begin(), events.begin()); e != events.end(); ++e) {
    while ((*e)->time - step->time > 1e-3 * (*e)->duration) ++step;
    const double touch = (*e)->time - (*e)->touch_age;
    if (!std::isfinite(touch) || (*e)->impulse.norm() < step->impulse.norm() / 3) continue;
    step->touch = step->has_touch ? std::min(step->touch, touch) : touch;
    step->has_touch = true;
  }
  return steps;
}

std::vector<Touch> blows_of(BodyId body, const std::vector<Step>& steps) {
  sound::ContactForce force;
  std::vector<Touch> blows;
  double last = -1;
  for (const Step& step : steps) {
    if (step.time - last > 1.5 * step.duration) force.step(Vec3::Zero());
    last = step.time;
    if (const double blow = force.step(step.impulse).norm(); blow > 0)
      blows.push_back({step.touch, body, blow});
  }
  const auto is_outdone = [&](const Touch& touch) {
    const auto from = std::partition_point(
        blows.begin(), blows.end(), [&](const Touch& t) { return t.time < touch.time - Touch::apart; });
    return std::any_of(from, blows.end(), [&](const Touch& t) {
      if (std::abs(t.time - touch.time) > Touch::apart) return false;
      return t.impulse > touch.impulse || (t.impulse == touch.impulse && t.time < touch.time);
    });
  };
  std::vector<Touch> kept;
  std::copy_if(blows.begin(), blows.end(), std::back_inserter(kept),
               [&](const Touch& touch) { return !is_outdone(touch); });
  return kept;
}

}  // namespace

std::vector<Touch> touches_of(const Recording& recording) {
  std::map<std::pair<BodyId, BodyId>, std::vector<const ContactEvent*>> pairs;
  for (const ContactEvent& event : recording.events) {
    if (std::isfinite(event.time) && std::isfinite(event.duration) && event.impulse.allFinite() &&
        event.time >= 0)
      pairs[{event.body, event.other}].push_back(&event);
  }
  std::vector<Touch> touches;
  for (auto& [pair, events] : pairs) {
    std::stable_sort(events.begin(), events.end(),
                     [](const ContactEvent* a, const ContactEvent* b) { return a->time < b->time; });
    const std::vector<Touch> blows = blows_of(pair.first, steps_of(events));
    touches.insert(touches.end(), blows.begin(), blows.end());
  }
  std::map<BodyId, double> most = strongest(touches);
  std::erase_if(touches, [&](const Touch& touch) { return touch.impulse < Touch::least * most[touch.body]; });
  std::stable_sort(touches.begin(), touches.end(),
                   [](const Touch& a, const Touch& b) { return a.time < b.time; });
  return touches;
}

std::vector<Touch> unmasked(std::span<const Touch> touches) {
  std::map<BodyId, double> most = strongest(touches);
  std::vector<Touch> out;
  for (std::size_t k = 0; k < touches.size(); ++k) {
    bool stands = touches[k].impulse >= stands_out * most[touches[k].body];
    for (std::size_t i = k; stands && i-- > 0 && touches[k].time - touches[i].time < masks_for;)
      stands = touches[i].impulse <= masks_from * touches[k].impulse;
    if (stands) out.push_back(touches[k]);
  }
  return out;
}

}  // namespace intaglio::session
