#include "report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "haptics/guard.h"
#include "intaglio/representation.h"
#include "report/agreement.h"
#include "report/contacts.h"
#include "report/html.h"
#include "report/spectrogram.h"

namespace intaglio::report {

namespace {

constexpr std::size_t most_key_frames = 8;
constexpr int key_frame_width = 400;

std::string section(std::string_view id, std::string_view heading, std::string_view sentence,
                    const std::string& content) {
  return fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-heading\">\n<h2 "
      "id=\"{0}-heading\">{1}</h2>\n<p>{2}</p>\n{3}</section>\n",
      id, heading, sentence, content);
}

std::string_view representation_text(Representation representation) {
  switch (representation) {
    case Representation::flat:
      return "as a flat surface";
    case Representation::normal:
      return "by its normals";
    case Representation::relief:
      return "as relief";
  }
  return "";
}

std::string participants_text(const session::Recording& recording) {
  static constexpr std::array words = {"", "One ball", "Two balls", "Three balls", "Four balls"};
  const std::size_t balls = recording.balls.size();
  std::string who = balls < words.size() ? words[balls] : fmt::format("{} balls", balls);
  if (!recording.servo.empty()) who += who.empty() ? "A pen" : " and a pen";
  return who.empty() ? "Nothing" : who;
}

// A one-sentence summary.
std::string summary_sentence(const session::Recording& recording) {
  std::string where = "no surface";
  if (recording.surface) {
    const surface::Placement& placement = recording.surface->placement();
    where = fmt::format("a surface of {}&nbsp;m by {}&nbsp;m {}", format_number(placement.size_u()),
                        format_number(placement.size_v()), representation_text(recording.representation));
  }
  return fmt::format(
      "{} on {}, for {}&nbsp;s: one texture, seen at {}&nbsp;frames a second, felt at {}&nbsp;Hz, moved at "
      "{}&nbsp;Hz and heard at {}&nbsp;Hz.",
      participants_text(recording), where, format_number(recording.duration, 1), recording.fps,
      recording.servo_rate, recording.physics_rate, recording.sample_rate);
}

// At most most_key_frames, evenly spaced.
std::string key_frame_strip(const session::Recording& recording) {
  const std::size_t shown = std::min(recording.key_frames.size(), most_key_frames);
  std::string html = "<ul class=\"strip\">\n";
  for (std::size_t k = 0; k < shown; ++k) {
    const session::KeyFrame& frame = recording.key_frames[k * recording.key_frames.size() / shown];
    if (frame.image.empty()) continue;
    const std::string time = format_number(frame.time, 2);
    html += fmt::format(
        "<li><figure><img alt=\"The scene at {0} s\" "
        "src=\"{1}\"><figcaption>{0}&nbsp;s</figcaption></figure></li>\n",
        time, data_uri(downscaled(frame.image, key_frame_width)));
  }
  // An empty <ul> is invalid.
  return html.find("<li>") == std::string::npos ? "<p>No pictures were kept.</p>\n" : html + "</ul>\n";
}

std::string picture(const session::Recording& recording, std::span<const std::uint8_t> video) {
  std::string html;
  if (!video.empty()) {
    html = fmt::format(
        "<video controls preload=\"metadata\" aria-label=\"The session, with its sound\" "
        "src=\"{}\"></video>\n",
        data_uri("video/mp4", video));
  }
  return html + key_frame_strip(recording);
}

// The tracks, with the mapping of their time axis for the script.
std::string tracks(const session::Recording& recording) {
  return fmt::format(
             "<div id=\"tracks\" data-left=\"{}\" data-right=\"{}\" data-width=\"{}\" "
             "data-duration=\"{}\">\n",
             track_area.low, track_area.high, track_width, shown_duration(recording)) +
         section("felt", "Felt",
                 "The pen’s tip follows the surface and sinks into it a little; the force is the spring’s. "
                 "Shaded: in contact.",
                 felt_html(recording)) +
         section("moved", "Moved",
                 "The lowest point of each ball above the base plane, and its speed. Vertical lines mark the "
                 "strongest impacts.",
                 moved_html(recording)) +
         section("heard", "Heard",
                 "Each contact excites the modes of its bodies, marked at the right. The analysis window "
                 "spreads onsets by about 20&nbsp;ms.",
                 heard_html(recording)) +
         "</div>\n";
}

}  // namespace

std::string report_html(const session::Recording& recording, std::span<const std::uint8_t> video_mp4) {
  const std::string title = recording.title.empty() ? "Session" : recording.title;
  std::string html = page_head(title + " – Intaglio", report_css);
  html += fmt::format("<header>\n<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", escape_html(title),
                      summary_sentence(recording));
  html += picture(recording, video_mp4) + "</header>\n";
  html +=
      section("seen", "Seen",
              "The height map from above, with the paths of balls and pen, dark at the start and bright at "
              "the end.",
              seen_html(recording));
  html += tracks(recording);
  html += section("agreement", "Agreement", "How well the senses agree in this recording.",
                  agreement_html(measure_agreement(recording)));
  html += section("cost", "Cost and identity", "Resources used, and the hashes that identify the run.",
                  "<div class=\"wide\">" + cost_table(recording) + "</div>\n<div class=\"wide\">" +
                      voice_table(recording) + "</div>\n<div class=\"wide\">" + run_table(recording) +
                      "</div>\n");
  return html + fmt::format("</main>\n<script>{}</script>\n</body>\n</html>\n", report_script);
}

namespace {

std::string cell(std::string_view text) {
  return fmt::format("<td>{}</td>", text);
}
std::string figure(std::string_view text) {
  return fmt::format("<td class=\"figure\">{}</td>", text);
}
std::string header_cell(std::string_view text) {
  return fmt::format("<th scope=\"col\">{}</th>", text);
}
std::string figure_header_cell(std::string_view text) {
  return fmt::format("<th scope=\"col\" class=\"figure\">{}</th>", text);
}
std::string table_head(std::string_view caption, const std::string& headings) {
  return fmt::format("<table>\n<caption>{}</caption>\n<thead><tr>{}</tr></thead>\n<tbody>\n", caption,
                     headings);
}
std::string figure_row(std::string_view name, std::string_view value) {
  return table_row(name, figure(value));
}

// "10 to 13", or one number when both are the same.
std::string range_text(double low, double high) {
  const std::string a = format_number(low), b = format_number(high);
  return a == b ? a : a + " to " + b;
}

std::string lowest_text(const std::vector<double>& frequencies) {
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(frequencies.size(), 5); ++k)
    text += (k > 0 ? ", " : "") + format_number(frequencies[k], 0);
  return text.empty() ? "–" : text + (frequencies.size() > 5 ? ", …" : "");
}

}  // namespace

std::string cost_table(const session::Recording& recording) {
  std::string html = table_head(
      "Cost of each sense, in CPU time of its thread. The real-time factor is simulated time over CPU "
      "time: above 1 is faster than real time.",
      header_cell("Sense") + header_cell("Step") + figure_header_cell("Steps") +
          figure_header_cell("Median, µs") + figure_header_cell("99 %, µs") + figure_header_cell("All, s") +
          figure_header_cell("Real-time factor"));
  for (const session::SenseCost& cost : recording.costs) {
    const double simulated = cost.step_seconds * double(cost.steps);
    html += fmt::format("<tr><th scope=\"row\">{}</th>", escape_html(cost.sense)) +
            cell(escape_html(cost.step)) + figure(std::to_string(cost.steps)) +
            figure(format_number(cost.median_us)) + figure(format_number(cost.p99_us)) +
            figure(format_number(cost.total_s, 3)) +
            figure(cost.total_s > 0 ? format_number(simulated / cost.total_s) : "–") + "</tr>\n";
  }
  if (recording.costs.empty()) html += "<tr><td colspan=\"7\">–</td></tr>\n";
  return html + "</tbody></table>\n";
}

std::string run_table(const session::Recording& recording) {
  std::string html =
      "<table>\n<caption>The run. Two runs of one scene have the same hashes.</caption>\n<tbody>\n";
  html += figure_row("Simulated time, s", format_number(recording.duration, 2));
  html += figure_row("Wall time, s", format_number(recording.wall_s, 2));
  html += figure_row("Modal analysis, CPU s", format_number(recording.bake_s, 2));
  html += figure_row("Memory of the surface", format_bytes(recording.surface_bytes));
  html += figure_row("Peak memory of the process", format_bytes(recording.peak_memory_bytes));
  html += figure_row("Contact events", std::to_string(recording.events.size()));
  html += figure_row("Momentum residual, N s", format_number(recording.momentum_residual));
  html += figure_row("Hash of the events", fmt::format("<code>{}</code>", format_hex(recording.event_hash)));
  html += figure_row("Hash of the audio", fmt::format("<code>{}</code>", format_hex(recording.audio_hash)));
  return html + "</tbody></table>\n";
}

std::string voice_table(const session::Recording& recording) {
  std::string html = table_head("Voices: what was baked for each body.",
                                header_cell("Body") + header_cell("Material") + figure_header_cell("Modes") +
                                    header_cell("Lowest frequencies, Hz") + header_cell("T60, ms"));
  for (const scene::Voice& voice : recording.voices) {
    const auto [shortest, longest] = std::minmax_element(voice.t60.begin(), voice.t60.end());
    html += fmt::format("<tr><th scope=\"row\"><span class=\"dot {}\"></span>{}</th>",
                        body_css_class(voice.body, recording.pen), escape_html(voice.name)) +
            cell(escape_html(voice.material)) + figure(std::to_string(voice.frequencies.size())) +
            cell(lowest_text(voice.frequencies)) +
            cell(voice.t60.empty() ? "–" : range_text(1e3 * *shortest, 1e3 * *longest)) + "</tr>\n";
  }
  if (recording.voices.empty()) html += "<tr><td colspan=\"5\">–</td></tr>\n";
  return html + "</tbody></table>\n";
}

// Tracks.

namespace {

constexpr double track_axis_height = 30;  // of the time axis, below the lowest panel
constexpr int track_time_ticks = 12;

// Legend entry right of the plot, `row` from the top.
void add_legend(SvgPlot& plot, const Axis& y, int row, std::string_view name, std::string_view classes) {
  const double x = track_area.high + 14, at = y.units().high + 12 + 18 * row;
  plot.line(x, at - 4, x + 16, at - 4, fmt::format("curve {}", classes));
  plot.text(x + 22, at, name, "tick");
}

double step_of(int rate) {
  return rate > 0 ? 1.0 / rate : std::nan("");
}

struct PenSeries {
  std::vector<double> tip, surface, force;  // mm, mm, N
  Range heights;                            // plotted: where it touches, and a margin above
};

PenSeries pen_series(const session::Recording& recording) {
  PenSeries pen;
  std::vector<double> shown;
  for (const haptics::ServoSample& sample : recording.servo) {
    pen.tip.push_back(recording.surface ? 1e3 * recording.surface->placement().to_local(sample.tip).z()
                                        : 1e3 * sample.tip.y());
    pen.surface.push_back(1e3 * sample.surface_height);
    pen.force.push_back(sample.force.norm());
    shown.push_back(pen.surface.back());
    if (sample.touching) shown.push_back(pen.tip.back());
  }
  const Range range = range_of(shown);
  pen.heights = {range.low - 0.1 * range.size(), range.high + 0.4 * range.size()};
  return pen;
}

void draw_force(SvgPlot& plot, const Axis& time, const Axis& y, const Series& force) {
  plot.envelope(time, y, {force.start, force.step, force.values}, "area pen");
  plot.curve(time, y, force, "curve pen");
  plot.y_axis(time, y, "force, N", 3);
  const double limit = haptics::GuardLimits{}.peak_force;
  if (limit > y.values().high) return;
  plot.line(track_area.low, y(limit), track_area.high, y(limit), "limit");
  plot.text(track_area.high + 14, y(limit) + 4, format_number(limit, 1) + " N, the guard", "tick");
}

struct BallSeries {
  std::string name, colour;
  std::vector<double> height, speed;  // m, m/s
};

BallSeries ball_series(const session::Recording& recording, const session::BallTrack& ball) {
  BallSeries series{body_name(recording, ball.body), body_css_class(ball.body, recording.pen), {}, {}};
  for (std::size_t k = 0; k < ball.position.size(); ++k) {
    const Vec3& centre = ball.position[k];
    const double height =
        recording.surface ? recording.surface->placement().to_local(centre).z() : centre.y();
    series.height.push_back(height - ball.radius);
    series.speed.push_back(k > 0 ? (centre - ball.position[k - 1]).norm() * recording.physics_rate
                                 : std::nan(""));
  }
  return series;
}

// Limits the axis for balls that have fallen off.
Range height_range(const session::Recording& recording, const std::vector<BallSeries>& balls) {
  std::vector<double> all;
  for (const BallSeries& ball : balls) all.insert(all.end(), ball.height.begin(), ball.height.end());
  all.push_back(0);
  Range range = range_of(all);
  const double relief = recording.surface ? recording.surface->max_depth() : 0;
  range.low = std::max(range.low, -std::max({0.5 * range.high, 1.5 * relief, 0.01}));
  return range.padded(0.06);
}

Range speed_range(const std::vector<BallSeries>& balls) {
  std::vector<double> all = {0};
  for (const BallSeries& ball : balls) all.insert(all.end(), ball.speed.begin(), ball.speed.end());
  return {0, 1.08 * range_of(all, {0, 1}).high};
}

// Vertical lines at the strongest impacts, through all panels of a track.
void draw_impacts(SvgPlot& plot, const session::Recording& recording, double top, double bottom) {
  const Axis time = time_axis(recording);
  for (const Impact& impact : strongest(find_impacts(recording), 40, 0.03)) {
    if (impact.time < 0 || impact.time > time.values().high) continue;
    plot.line(time(impact.time), top, time(impact.time), bottom,
              fmt::format("impact {}", body_css_class(impact.body, recording.pen)));
  }
}

}  // namespace

Axis time_axis(const session::Recording& recording) {
  return Axis({0, shown_duration(recording)}, track_area);
}

std::string felt_html(const session::Recording& recording) {
  if (recording.servo.empty()) return "<p>No pen took part.</p>\n";
  const PenSeries pen = pen_series(recording);
  const double step = step_of(recording.servo_rate);
  const double most = range_of(pen.force, {0, 1}).high, limit = haptics::GuardLimits{}.peak_force;
  const Axis time = time_axis(recording);
  const Axis height(pen.heights, {166, 10});
  const Axis force({0, most > 0.75 * limit && most < 1.05 * limit ? 1.12 * limit : 1.1 * most}, {270, 186});
  SvgPlot plot(track_width, force.units().low + track_axis_height, "plot track", "Felt",
               "The height of the pen’s tip and of the surface under it, and the force on the hand, over "
               "time. Shaded where the pen touches.");
  for (const TimeSpan& touch : pen_touches(recording)) {
    plot.rectangle(time(touch.begin), height.units().high, time(touch.end) - time(touch.begin),
                   force.units().low - height.units().high, "touch");
  }
  plot.y_axis(time, height, "height, mm", 4);
  draw_impacts(plot, recording, height.units().high, force.units().low);
  plot.curve(time, height, {0, step, pen.surface}, "curve floor");
  plot.curve(time, height, {0, step, pen.tip}, "curve pen");
  add_legend(plot, height, 0, "pen’s tip", "pen");
  add_legend(plot, height, 1, "surface", "floor");
  draw_force(plot, time, force, {0, step, pen.force});
  plot.x_axis(time, force.units().low, "s", track_time_ticks);
  return plot.finish();
}

std::string moved_html(const session::Recording& recording) {
  std::vector<BallSeries> balls;
  for (const session::BallTrack& ball : recording.balls) balls.push_back(ball_series(recording, ball));
  if (balls.empty()) return "<p>No ball took part.</p>\n";
  const double step = step_of(recording.physics_rate);
  const Axis time = time_axis(recording);
  const Range heights = height_range(recording, balls);
  const bool in_mm = heights.size() < 0.1;
  const Axis height({heights.low * (in_mm ? 1e3 : 1), heights.high * (in_mm ? 1e3 : 1)}, {140, 10});
  const Axis speed(speed_range(balls), {244, 160});
  SvgPlot plot(track_width, speed.units().low + track_axis_height, "plot track", "Moved",
               "The height of each ball’s lowest point above the base plane, and its speed, over time.");
  plot.y_axis(time, height, in_mm ? "height, mm" : "height, m", 4);
  plot.y_axis(time, speed, "speed, m/s", 3);
  draw_impacts(plot, recording, height.units().high, speed.units().low);
  plot.line(track_area.low, height(0), track_area.high, height(0), "curve floor thin");
  add_legend(plot, height, 0, "base plane", "floor thin");
  int row = 1;
  for (BallSeries& ball : balls) {
    if (in_mm)
      std::transform(ball.height.begin(), ball.height.end(), ball.height.begin(),
                     [](double h) { return 1e3 * h; });
    plot.curve(time, height, {step, step, ball.height}, "curve " + ball.colour);
    plot.curve(time, speed, {step, step, ball.speed}, "curve " + ball.colour);
    if (row < 7) add_legend(plot, height, row++, ball.name, ball.colour);
  }
  plot.x_axis(time, speed.units().low, "s", track_time_ticks);
  return plot.finish();
}

namespace {

constexpr double balls_y = 52, pen_y = 62, spectrogram_top = 80, spectrogram_bottom = 360, wave_top = 374,
                 wave_bottom = 434;
constexpr double shown_decibels = 80;

// The loudest bin at the top of the scale, in steps of 5 dB.
SpectrogramView view_of(const session::Recording& recording, const Spectrogram& spectrogram) {
  const auto loudest = std::max_element(spectrogram.power.begin(), spectrogram.power.end());
  SpectrogramView view;
  view.duration = shown_duration(recording);
  view.high_hz = std::max(std::min(20000.0, 0.5 * recording.sample_rate), 2 * view.low_hz);
  view.top_db = 5 * std::ceil(level_db(loudest == spectrogram.power.end() ? 0.0 : double(*loudest), -60) / 5);
  view.floor_db = view.top_db - shown_decibels;
  return view;
}

// Contact marks: a triangle for each impact of a ball, a bar while the pen touches.
void draw_contacts(SvgPlot& plot, const session::Recording& recording, const Axis& time) {
  const std::vector<Impact> impacts = strongest(find_impacts(recording), 400, 0);
  double most = 0;
  for (const Impact& impact : impacts) most = std::max(most, impact.impulse);
  plot.line(track_area.low, balls_y, track_area.high, balls_y, "grid");
  for (const Impact& impact : impacts) {
    if (impact.time < 0 || impact.time > time.values().high) continue;
    const std::string tip = fmt::format("{} at {} s: {} N s", body_name(recording, impact.body),
                                        format_number(impact.time, 3), format_number(impact.impulse));
    plot.triangle(time(impact.time), balls_y, most > 0 ? 5 + 19 * std::sqrt(impact.impulse / most) : 5,
                  fmt::format("mark {}", body_css_class(impact.body, recording.pen)), tip);
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
void draw_modes(SvgPlot& plot, const session::Recording& recording, const Axis& hz) {
  const double pitch = std::min(18.0, 110.0 / double(std::max<std::size_t>(recording.voices.size(), 1)));
  double x = track_area.high + 10;
  for (const scene::Voice& voice : recording.voices) {
    const std::string colour = body_css_class(voice.body, recording.pen);
    double last = 1e9;
    for (const double frequency : voice.frequencies) {
      if (!(frequency >= hz.values().low && frequency <= hz.values().high)) continue;
      // Skip marks closer than half a unit.
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
    for (int c = 0; c < 3; ++c) bar.at(x, 0, c) = colour[std::size_t(c)];
  }
  plot.text(left, y - 6, "power, dB", "tick");
  plot.image(left, y, width, 10, data_uri(bar));
  plot.text(left, y + 25, format_number(view.floor_db, 0), "tick");
  plot.text(left + width, y + 25, format_number(view.top_db, 0), "tick", TextAnchor::end);
}

}  // namespace

std::string heard_html(const session::Recording& recording) {
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

}  // namespace intaglio::report
