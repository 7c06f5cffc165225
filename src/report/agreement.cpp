#include "report/agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "report/html.h"

namespace intaglio::report {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Signed distance to the nearest of `times` (sorted).
double nearest_offset(const std::vector<double>& times, double time) {
  double best = std::numeric_limits<double>::infinity();
  const auto next = std::lower_bound(times.begin(), times.end(), time);
  if (next != times.end()) best = time - *next;
  if (next != times.begin() && time - *(next - 1) < std::abs(best)) best = time - *(next - 1);
  return best;
}

// Fractions of `onsets`, and of all time, that are near one of `times` (sorted); `covered`: how much of the
// duration was looked at, s.
std::pair<double, double> hits_and_chance(const std::vector<double>& onsets, const std::vector<double>& times,
                                          double duration, double covered) {
  const auto near = [&](double onset) {
    return std::abs(nearest_offset(times, onset)) <= Agreement::tolerance;
  };
  TimeSpans spans(duration);
  for (const double time : times) spans.add({time - Agreement::tolerance, time + Agreement::tolerance});
  const auto hits = double(std::count_if(onsets.begin(), onsets.end(), near));
  return {ratio(hits, double(onsets.size())), spans.total() / covered};
}

std::vector<double> times_of(const std::vector<AudibleTouch>& touches) {
  std::vector<double> times;
  for (const AudibleTouch& touch : touches) times.push_back(touch.time);
  return times;
}

void compare_onsets(const Digest& digest, Agreement& a) {
  const TouchFinder& found = digest.contacts().touches();
  a.stride = std::max(found.stride(), digest.sound().onsets().stride());
  const double duration = digest.duration(), covered = covered_time(duration, a.stride);
  const std::vector<double> onsets = digest.sound().onsets().onsets(a.stride);
  const std::vector<AudibleTouch> touches = found.touches(a.stride);
  const std::vector<double> all = times_of(touches), audible = times_of(unmasked(touches));
  a.onsets = onsets.size();
  std::tie(a.onsets_at_touch, a.onset_chance) = hits_and_chance(onsets, all, duration, covered);
  a.touches = audible.size();
  std::tie(a.touches_heard, a.touch_chance) = hits_and_chance(audible, onsets, duration, covered);
  std::vector<double> lags;
  for (const double onset : onsets) {
    if (const double value = nearest_offset(all, onset); std::abs(value) <= Agreement::tolerance)
      lags.push_back(value);
  }
  std::sort(lags.begin(), lags.end());
  a.median_lag = lags.empty() ? unknown : lags[lags.size() / 2];
}

void compare_relief(const Digest& digest, Agreement& a) {
  const Correlation& relief = digest.pen().relief;
  a.touching_ticks = relief.count();
  // A flat surface correlates with nothing: below a tenth of a micrometre there is no relief to follow.
  a.relief_correlation = relief.value(1e-14);
}

void compare_silence(const Digest& digest, Agreement& a) {
  a.idle_seconds = digest.duration() - digest.sound().busy_seconds();
  a.idle_energy =
      a.idle_seconds > 0.01 ? ratio(digest.sound().idle_energy(), digest.sound().energy()) : unknown;
}

// Baked frequencies of the bodies that took part in a contact.
std::vector<double> excited_frequencies(const Digest& digest) {
  std::vector<double> frequencies;
  for (const scene::Voice& voice : digest.run().voices) {
    if (!digest.contacts().touched().contains(voice.body)) continue;
    for (const double hz : voice.frequencies) {
      if (std::isfinite(hz) && hz > 0) frequencies.push_back(hz);
    }
  }
  return frequencies;
}

void compare_modes(const Digest& digest, Agreement& a) {
  a.modal_energy = a.modal_chance = a.modal_contrast_db = unknown;
  const std::vector<double> modes = excited_frequencies(digest);
  if (modes.empty() || digest.sound().samples() == 0) return;
  const ModalSpectrum spectrum(digest.sound().mean_power(), digest.sound().bin_hz(), modes,
                               Agreement::mode_width);
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

Agreement measure_agreement(const Digest& digest) {
  Agreement a;
  compare_onsets(digest, a);
  compare_relief(digest, a);
  compare_silence(digest, a);
  compare_modes(digest, a);
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
  html += "</dl>\n";
  if (a.stride > 1)
    html += fmt::format(
        "<p class=\"note\">There were more touches and onsets than the report keeps: the first two figures "
        "compare those of one in {} windows of ten seconds.</p>\n",
        a.stride);
  return html;
}

}  // namespace intaglio::report
