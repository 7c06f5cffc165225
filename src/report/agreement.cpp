#include "report/agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "report/contacts.h"
#include "report/html.h"
#include "report/spectrogram.h"
#include "sound/contact_step.h"

namespace intaglio::report {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

double square(float value) {
  return std::isfinite(value) ? double(value) * double(value) : 0;
}

// Onset times, s: milliseconds whose energy is at least 6 dB above each of the previous 30 and within 40 dB
// of the loudest; at most one per 30 ms. The energy is that of the first difference, which emphasises treble:
// low modes ring on from one impact to the next, high ones start anew.
std::vector<double> loud_onsets(std::span<const float> audio, double sample_rate) {
  std::vector<double> onsets;
  if (!(sample_rate >= 1000)) return onsets;
  const auto slot = std::size_t(sample_rate / 1000);
  std::vector<double> energy(audio.size() / slot, 0.0);
  for (std::size_t k = 0; k < energy.size() * slot; ++k)
    energy[k / slot] += square(k > 0 ? audio[k] - audio[k - 1] : audio[k]);
  const auto loudest = std::max_element(energy.begin(), energy.end());
  if (loudest == energy.end() || !(*loudest > 0)) return onsets;
  const double loud = 1e-4 * *loudest;
  const std::size_t rest = 30;  // slots
  for (std::size_t k = 0; k < energy.size(); ++k) {
    const auto here = energy.begin() + std::ptrdiff_t(k);
    const auto before = std::max(energy.begin(), here - std::ptrdiff_t(std::min(k, rest)));
    const double most_before = before == here ? 0 : *std::max_element(before, here);
    if (energy[k] < loud || energy[k] < 4 * most_before) continue;
    onsets.push_back(double(k * slot) / sample_rate);
    k += rest;
  }
  return onsets;
}

// Signed distance to the nearest of `times` (sorted).
double nearest_offset(const std::vector<double>& times, double time) {
  double best = std::numeric_limits<double>::infinity();
  const auto next = std::lower_bound(times.begin(), times.end(), time);
  if (next != times.end()) best = time - *next;
  if (next != times.begin() && time - *(next - 1) < std::abs(best)) best = time - *(next - 1);
  return best;
}

// Fractions of `onsets`, and of all time, that are near one of `times` (sorted).
std::pair<double, double> hits_and_chance(const std::vector<double>& onsets, const std::vector<double>& times,
                                          double duration) {
  const auto near = [&](double onset) {
    return std::abs(nearest_offset(times, onset)) <= Agreement::tolerance;
  };
  std::vector<TimeSpan> spans;
  for (const double time : times) spans.push_back({time - Agreement::tolerance, time + Agreement::tolerance});
  const auto hits = double(std::count_if(onsets.begin(), onsets.end(), near));
  return {ratio(hits, double(onsets.size())), total_duration(merged(spans, duration)) / duration};
}

std::vector<double> times_of(const std::vector<AudibleTouch>& touches) {
  std::vector<double> times;
  for (const AudibleTouch& touch : touches) times.push_back(touch.time);
  return times;
}

void compare_onsets(const session::Recording& recording, Agreement& a) {
  const double duration = shown_duration(recording);
  const std::vector<double> onsets = loud_onsets(recording.audio, recording.sample_rate);
  const std::vector<AudibleTouch> touches = find_touches(recording);
  const std::vector<double> all = times_of(touches), audible = times_of(unmasked(touches));
  a.onsets = onsets.size();
  std::tie(a.onsets_at_touch, a.onset_chance) = hits_and_chance(onsets, all, duration);
  a.touches = audible.size();
  std::tie(a.touches_heard, a.touch_chance) = hits_and_chance(audible, onsets, duration);
  std::vector<double> lags;
  for (const double onset : onsets) {
    if (const double value = nearest_offset(all, onset); std::abs(value) <= Agreement::tolerance)
      lags.push_back(value);
  }
  std::sort(lags.begin(), lags.end());
  a.median_lag = lags.empty() ? unknown : lags[lags.size() / 2];
}

void compare_relief(const session::Recording& recording, Agreement& a) {
  a.relief_correlation = unknown;
  if (!recording.surface) return;
  std::vector<Vec2> pairs;  // (tip, surface), m
  for (const haptics::ServoSample& sample : recording.servo) {
    const Vec2 pair(recording.surface->placement().to_local(sample.tip).z(), sample.surface_height);
    // Discard outliers beyond a kilometre: simulation faults.
    if (sample.touching && pair.allFinite() && pair.cwiseAbs().maxCoeff() < 1e3) pairs.push_back(pair);
  }
  a.touching_ticks = pairs.size();
  if (pairs.size() < 2) return;
  Vec2 mean = Vec2::Zero();
  for (const Vec2& pair : pairs) mean += pair / double(pairs.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Vec2& pair : pairs)
    covariance += (pair - mean) * (pair - mean).transpose() / double(pairs.size());
  // A flat surface correlates with nothing: below a tenth of a micrometre there is no relief to follow.
  if (covariance.diagonal().minCoeff() > 1e-14) {
    a.relief_correlation = covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1));
  }
}

double longest_ring(const session::Recording& recording) {
  double longest = 0;
  for (const scene::Voice& voice : recording.voices) {
    for (const double t60 : voice.t60) {
      if (std::isfinite(t60)) longest = std::max(longest, t60);
    }
  }
  return longest > 0 ? longest : 0.5;
}

void compare_silence(const session::Recording& recording, Agreement& a) {
  const double duration = shown_duration(recording), ring = longest_ring(recording);
  std::vector<TimeSpan> busy;
  for (const ContactEvent& event : recording.events) {
    const bool sounds = event.phase == ContactPhase::begin || event.v_t.norm() > Agreement::still_speed ||
                        event.spin.norm() > Agreement::still_speed;
    if (sounds && std::isfinite(event.time) && std::isfinite(event.duration))
      busy.push_back({event.time - event.duration, event.time + ring});
  }
  busy = merged(std::move(busy), duration);
  a.idle_seconds = duration - total_duration(busy);
  double idle = 0, all = 0;
  auto span = busy.begin();
  for (std::size_t k = 0; k < recording.audio.size() && recording.sample_rate > 0; ++k) {
    const double time = double(k) / recording.sample_rate;
    while (span != busy.end() && time >= span->end) ++span;
    all += square(recording.audio[k]);
    if (span == busy.end() || time < span->begin) idle += square(recording.audio[k]);
  }
  a.idle_energy = a.idle_seconds > 0.01 ? ratio(idle, all) : unknown;
}

// Baked frequencies of the bodies that took part in a contact.
std::vector<double> excited_frequencies(const session::Recording& recording) {
  std::set<BodyId> touched;
  for (const ContactEvent& event : recording.events) touched.insert({event.body, event.other});
  std::vector<double> frequencies;
  for (const scene::Voice& voice : recording.voices) {
    if (touched.count(voice.body) == 0) continue;
    for (const double hz : voice.frequencies) {
      if (std::isfinite(hz) && hz > 0) frequencies.push_back(hz);
    }
  }
  return frequencies;
}

void compare_modes(const session::Recording& recording, Agreement& a) {
  a.modal_energy = a.modal_chance = a.modal_contrast_db = unknown;
  const std::vector<double> modes = excited_frequencies(recording);
  const Spectrogram spectrogram = make_spectrogram(recording.audio, recording.sample_rate, 16384);
  if (modes.empty() || spectrogram.frames == 0) return;
  const ModalSpectrum spectrum(spectrogram, modes, Agreement::mode_width);
  std::tie(a.modal_energy, a.modal_chance) = spectrum.energy_near_modes();
  const std::vector<double> contrasts = spectrum.contrasts_db();
  a.contrast_modes = contrasts.size();
  if (!contrasts.empty()) a.modal_contrast_db = contrasts[contrasts.size() / 2];
}

std::string percent(double fraction) {
  const double value = 100 * fraction;
  if (!std::isfinite(value)) return format_number(value, 0);
  if (value > 0 && value < 0.001) return "&lt;&nbsp;0.001&nbsp;%";
  const bool whole = value == 0 || value >= 99.95;
  return format_number(value, whole ? 0 : value < 1 ? 3 : value < 10 || value >= 99 ? 1 : 0) + "&nbsp;%";
}

// " The median onset is 0.5 ms before its contact."
std::string lag_sentence(double seconds) {
  if (!std::isfinite(seconds)) return "";
  return fmt::format(" The median onset is {}&nbsp;ms {} its contact.",
                     format_number(std::abs(1e3 * seconds), 1), seconds < 0 ? "before" : "after");
}

std::string item(std::string_view value, std::string_view name, std::string_view sentence) {
  return fmt::format("<div><dt>{}</dt><dd><b>{}</b> {}</dd></div>\n", name, value, sentence);
}

}  // namespace

Agreement measure_agreement(const session::Recording& recording) {
  Agreement a;
  compare_onsets(recording, a);
  compare_relief(recording, a);
  compare_silence(recording, a);
  compare_modes(recording, a);
  return a;
}

std::string agreement_html(const Agreement& a) {
  std::string html = "<dl class=\"agreement\">\n";
  html += item(
      percent(a.onsets_at_touch), "Touched when heard",
      fmt::format(
          "of the {} loud onsets in the audio lie within 5&nbsp;ms of a touch: a contact that begins, or "
          "an edge struck during one. Random onsets would score {}.{}",
          a.onsets, percent(a.onset_chance), lag_sentence(a.median_lag)));
  html +=
      item(percent(a.touches_heard), "Heard when touched",
           fmt::format("of the {} unmasked touches have a loud onset within 5&nbsp;ms; random onsets would "
                       "score {}.",
                       a.touches, percent(a.touch_chance)));
  html += item(format_number(a.relief_correlation, 3), "Felt what is there",
               fmt::format("is the correlation of the pen’s height with the height of the surface under it, "
                           "over {} ticks in contact. 1 is a pen that follows every groove.",
                           a.touching_ticks));
  html += item(percent(a.idle_energy), "Silent when nothing happens",
               fmt::format("of the audio’s energy falls into the {}&nbsp;s without beginning or sliding "
                           "contacts after all ringing is over. It should be next to nothing.",
                           format_number(a.idle_seconds, 2)));
  html += item(percent(a.modal_energy), "Sounds like its bodies",
               fmt::format("of the energy lies within 3&nbsp;% of a baked frequency of a body that was "
                           "touched; noise of equal energy per octave would score {}.",
                           percent(a.modal_chance)));
  html += item(format_number(a.modal_contrast_db, 1) + (std::isfinite(a.modal_contrast_db) ? "&nbsp;dB" : ""),
               "Rings above the floor",
               fmt::format("is the power near a baked frequency above that of its surroundings, the median "
                           "of the {} isolated modes.",
                           a.contrast_modes));
  return html + "</dl>\n";
}

namespace {

constexpr double masking_time = 0.1;      // s
constexpr double masking_fraction = 0.5;  // of an impulse: what masks it is stronger
constexpr double audible_fraction = 0.1;  // of the body's strongest

// One step of one pair.
struct PairStep {
  double time = 0, duration = 0;
  Vec3 impulse = Vec3::Zero();
  double touch_time = 0;
  bool is_exact = false;  // otherwise the middle of the step
};

std::map<BodyId, double> strongest_per_body(std::span<const AudibleTouch> touches) {
  std::map<BodyId, double> most;
  for (const AudibleTouch& touch : touches) most[touch.body] = std::max(most[touch.body], touch.impulse);
  return most;
}

std::vector<PairStep> steps_of(std::span<const ContactEvent* const> events) {
  std::vector<PairStep> steps;
  for (const ContactEvent* const e : events) {
    if (steps.empty() || e->time - steps.back().time > 1e-3 * e->duration)
      steps.push_back({e->time, e->duration, Vec3::Zero(), e->time - 0.5 * e->duration, false});
    steps.back().impulse += e->impulse;
  }
  // The earliest touch among points that carry at least a third of the step's impulse.
  for (auto [step, e] = std::pair(steps.begin(), events.begin()); e != events.end(); ++e) {
    while ((*e)->time - step->time > 1e-3 * (*e)->duration) ++step;
    const double touch = (*e)->time - (*e)->touch_age;
    if (!std::isfinite(touch) || (*e)->impulse.norm() < step->impulse.norm() / 3) continue;
    step->touch_time = step->is_exact ? std::min(step->touch_time, touch) : touch;
    step->is_exact = true;
  }
  return steps;
}

std::vector<AudibleTouch> find_blows(BodyId body, const std::vector<PairStep>& steps) {
  sound::ImpulseSplitter splitter;
  std::vector<AudibleTouch> blows;
  double last = -1;
  for (const PairStep& step : steps) {
    if (step.time - last > 1.5 * step.duration) splitter.split(Vec3::Zero());
    last = step.time;
    if (const double blow = splitter.split(step.impulse).norm(); blow > 0)
      blows.push_back({step.touch_time, body, blow});
  }
  const auto is_weaker_than_neighbour = [&](const AudibleTouch& touch) {
    const auto from = std::partition_point(blows.begin(), blows.end(), [&](const AudibleTouch& t) {
      return t.time < touch.time - AudibleTouch::merge_window;
    });
    return std::any_of(from, blows.end(), [&](const AudibleTouch& t) {
      if (std::abs(t.time - touch.time) > AudibleTouch::merge_window) return false;
      return t.impulse > touch.impulse || (t.impulse == touch.impulse && t.time < touch.time);
    });
  };
  std::vector<AudibleTouch> kept;
  std::copy_if(blows.begin(), blows.end(), std::back_inserter(kept),
               [&](const AudibleTouch& touch) { return !is_weaker_than_neighbour(touch); });
  return kept;
}

}  // namespace

std::vector<AudibleTouch> find_touches(const session::Recording& recording) {
  std::map<std::pair<BodyId, BodyId>, std::vector<const ContactEvent*>> pairs;
  for (const ContactEvent& event : recording.events) {
    if (std::isfinite(event.time) && std::isfinite(event.duration) && event.impulse.allFinite() &&
        event.time >= 0)
      pairs[{event.body, event.other}].push_back(&event);
  }
  std::vector<AudibleTouch> touches;
  for (auto& [pair, events] : pairs) {
    std::stable_sort(events.begin(), events.end(),
                     [](const ContactEvent* a, const ContactEvent* b) { return a->time < b->time; });
    const std::vector<AudibleTouch> blows = find_blows(pair.first, steps_of(events));
    touches.insert(touches.end(), blows.begin(), blows.end());
  }
  std::map<BodyId, double> most = strongest_per_body(touches);
  std::erase_if(touches, [&](const AudibleTouch& touch) {
    return touch.impulse < AudibleTouch::min_fraction * most[touch.body];
  });
  std::stable_sort(touches.begin(), touches.end(),
                   [](const AudibleTouch& a, const AudibleTouch& b) { return a.time < b.time; });
  return touches;
}

std::vector<AudibleTouch> unmasked(std::span<const AudibleTouch> touches) {
  std::map<BodyId, double> most = strongest_per_body(touches);
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
