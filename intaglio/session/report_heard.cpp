// The track of sound, apart from the others for its length.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "intaglio/session/report_contacts.h"
#include "intaglio/session/report_text.h"
#include "intaglio/session/report_tracks.h"
#include "intaglio/session/spectrogram.h"

namespace intaglio::session {

namespace {

constexpr double balls_y = 52, pen_y = 62, spectrogram_top = 80, spectrogram_bottom = 360, wave_top = 374,
                 wave_bottom = 434;
constexpr double shown_decibels = 80;

// The loudest bin at the top of the scale, in steps of 5 dB.
SpectrogramView view_of(const Recording& recording, const Spectrogram& spectrogram) {
  const auto loudest = std::max_element(spectrogram.power.begin(), spectrogram.power.end());
  SpectrogramView view;
  view.duration = shown_duration(recording);
  view.high_hz = std::max(std::min(20000.0, 0.5 * recording.sample_rate), 2 * view.low_hz);
  view.top_db =
      5 *
      std::ceil(level_db(loudest == spectrogram.power.end() ? 0.0 : static_cast<double>(*loudest), -60) / 5);
  view.floor_db = view.top_db - shown_decibels;
  return view;
}

// Who touched when: a triangle for each impact of a ball, a bar while the pen touches.
void draw_contacts(SvgPlot& plot, const Recording& recording, const Axis& time) {
  const std::vector<Impact> impacts = strongest(impacts_of(recording), 400, 0);
  double most = 0;
  for (const Impact& impact : impacts) most = std::max(most, impact.impulse);
  plot.line(track_area.low, balls_y, track_area.high, balls_y, "grid");
  for (const Impact& impact : impacts) {
    if (impact.time < 0 || impact.time > time.values().high) continue;
    const std::string tip = fmt::format("{} at {} s: {} N s", body_name(recording, impact.body),
                                        number(impact.time, 3), number(impact.impulse));
    plot.triangle(time(impact.time), balls_y, most > 0 ? 5 + 19 * std::sqrt(impact.impulse / most) : 5,
                  fmt::format("mark {}", body_class(impact.body, recording.pen)), tip);
  }
  for (const TimeSpan& touch : pen_touches(recording)) {
    plot.rectangle(time(touch.begin), pen_y, std::max(1.0, time(touch.end) - time(touch.begin)), 8,
                   "mark pen");
  }
  if (!recording.balls.empty())
    plot.text(track_area.low - 8, balls_y - 4, "impacts", "tick", TextAnchor::end);
  if (!recording.servo.empty()) plot.text(track_area.low - 8, pen_y + 8, "pen", "tick", TextAnchor::end);
}

// A column of ticks right of the spectrogram for each voice, at its baked frequencies.
void draw_modes(SvgPlot& plot, const Recording& recording, const Axis& hz) {
  const double pitch =
      std::min(18.0, 110.0 / static_cast<double>(std::max<std::size_t>(recording.voices.size(), 1)));
  double x = track_area.high + 10;
  for (const Voice& voice : recording.voices) {
    const std::string colour = body_class(voice.body, recording.pen);
    double last = 1e9;
    for (const double frequency : voice.frequencies) {
      if (!(frequency >= hz.values().low && frequency <= hz.values().high)) continue;
      // Marks closer than half a unit cannot be told apart.
      if (const double y = hz(frequency); std::abs(last - y) >= 0.5)
        plot.line(x, last = y, x + 0.72 * pitch, y, "mode " + colour);
    }
    plot.turned_text(x + 0.36 * pitch + 3, spectrogram_top - 6, 60, voice.name, "tick", TextAnchor::start);
    x += pitch;
  }
}

void draw_colour_bar(SvgPlot& plot, const SpectrogramView& view) {
  const double left = track_area.high + 12, width = 88, y = wave_top + 14;
  Image8 bar(64, 1, 3);
  for (int x = 0; x < bar.width; ++x) {
    const Rgb colour = magma((x + 0.5) / bar.width);
    for (int c = 0; c < 3; ++c) bar.at(x, 0, c) = colour[static_cast<std::size_t>(c)];
  }
  plot.text(left, y - 6, "power, dB", "tick");
  plot.image(left, y, width, 10, data_uri(bar));
  plot.text(left, y + 25, number(view.floor_db, 0), "tick");
  plot.text(left + width, y + 25, number(view.top_db, 0), "tick", TextAnchor::end);
}

}  // namespace

std::string heard_html(const Recording& recording) {
  if (recording.audio.empty() || recording.sample_rate <= 0) return "<p>No sound was recorded.</p>\n";
  const Axis time = time_axis(recording);
  const Spectrogram spectrogram = make_spectrogram(recording.audio, recording.sample_rate);
  const SpectrogramView view = view_of(recording, spectrogram);
  const Axis hz({view.low_hz, view.high_hz}, {spectrogram_bottom, spectrogram_top}, AxisScale::logarithmic);
  SvgPlot plot(track_width, wave_bottom + track_axis_height, "plot track", "Heard",
               "Contacts, spectrogram with the baked modal frequencies of each body at its right, and the "
               "waveform, over time.");
  draw_contacts(plot, recording, time);
  plot.image(track_area.low, spectrogram_top, track_area.size(), spectrogram_bottom - spectrogram_top,
             data_uri(spectrogram_image(spectrogram, view, 1200, 320)));
  plot.y_axis(time, hz, "frequency, Hz", 0);
  draw_modes(plot, recording, hz);
  std::vector<double> wave(recording.audio.begin(), recording.audio.end());
  const Range range = range_of(wave, {-1, 1});
  const double peak = std::max({std::abs(range.low), std::abs(range.high), 1e-3});
  const Axis level({-peak, peak}, {wave_bottom, wave_top});
  plot.y_axis(time, level, "wave", 4);
  plot.envelope(time, level, {0, 1.0 / recording.sample_rate, wave}, "wave");
  draw_impacts(plot, recording, balls_y, wave_bottom);
  draw_colour_bar(plot, view);
  plot.x_axis(time, wave_bottom, "s", track_time_ticks);
  return plot.finish();
}

}  // namespace intaglio::session
