#include "report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <span>
#include <system_error>
#include <vector>

#include "haptics/guard.h"
#include "intaglio/representation.h"
#include "report/agreement.h"
#include "report/html.h"
#include "report/seen.h"
#include "report/svg_plot.h"

namespace intaglio::report {

namespace fs = std::filesystem;

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

std::string participants_text(const Digest& digest) {
  static constexpr std::array words = {"", "One ball", "Two balls", "Three balls", "Four balls"};
  const std::size_t balls = digest.balls().size();
  std::string who = balls < words.size() ? words[balls] : fmt::format("{} balls", balls);
  if (digest.pen().ticks > 0) who += who.empty() ? "A pen" : " and a pen";
  return who.empty() ? "Nothing" : who;
}

// A one-sentence summary.
std::string summary_sentence(const Digest& digest) {
  const session::Run& run = digest.run();
  std::string where = "no surface";
  if (run.surface) {
    const surface::Placement& placement = run.surface->placement();
    where = fmt::format("a surface of {}&nbsp;m by {}&nbsp;m {}", format_number(placement.size_u()),
                        format_number(placement.size_v()), representation_text(run.representation));
  }
  return fmt::format(
      "{} on {}, for {}&nbsp;s: one texture, seen at {}&nbsp;frames a second, felt at {}&nbsp;Hz, moved at "
      "{}&nbsp;Hz and heard at {}&nbsp;Hz.",
      participants_text(digest), where, format_number(run.duration, 1), run.fps, run.servo_rate,
      run.physics_rate, run.sample_rate);
}

// At most most_key_frames, evenly spaced.
std::string key_frame_strip(const session::Run& run) {
  const std::size_t shown = std::min(run.key_frames.size(), most_key_frames);
  std::string html = "<ul class=\"strip\">\n";
  for (std::size_t k = 0; k < shown; ++k) {
    const session::KeyFrame& frame = run.key_frames[k * run.key_frames.size() / shown];
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

// Reads the video in pieces of a few megabytes, so that it is never held whole.
Result<void> embed(const fs::path& file, const std::function<void(std::string_view)>& out) {
  std::ifstream in(file, std::ios::binary);  // Not parsed: copied into the page
  std::vector<std::uint8_t> bytes(3 << 20);
  out("data:video/mp4;base64,");
  while (in) {
    in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
    out(base64(std::span(bytes).first(std::size_t(in.gcount()))));
  }
  if (!in.eof()) return fail(file.string(), "cannot be read");
  return {};
}

Result<void> write_video(const PageVideo& video, const std::function<void(std::string_view)>& out) {
  if (video.file.empty()) return {};
  std::error_code error;
  const std::uintmax_t size = fs::file_size(video.file, error);
  if (error) return fail(video.file.string(), "cannot be read: " + error.message());
  out("<video controls preload=\"metadata\" aria-label=\"The session, with its sound\" src=\"");
  const bool is_embedded = size <= video.most_embedded;
  if (is_embedded) {
    if (auto embedded = embed(video.file, out); !embedded) return embedded;
  } else {
    out(url_encoded(video.link));
  }
  out("\"></video>\n");
  if (!is_embedded)
    out(
        fmt::format("<p class=\"note\">The video, {}, is too large to be in this page: keep <a "
                    "href=\"{}\">{}</a> beside it.</p>\n",
                    format_bytes(size), url_encoded(video.link), escape_html(video.link)));
  return {};
}

// The tracks, with the mapping of their time axis for the script.
std::string tracks(const Digest& digest) {
  return fmt::format(
             "<div id=\"tracks\" data-left=\"{}\" data-right=\"{}\" data-width=\"{}\" "
             "data-duration=\"{}\">\n",
             track_area.low, track_area.high, track_width, digest.duration()) +
         section("felt", "Felt",
                 "The pen’s tip follows the surface and sinks into it a little; the force is the spring’s. "
                 "Shaded: in contact.",
                 felt_html(digest)) +
         section("moved", "Moved",
                 "The lowest point of each ball above the base plane, and its speed. Vertical lines mark the "
                 "strongest impacts.",
                 moved_html(digest)) +
         section("heard", "Heard",
                 "Each contact excites the modes of its bodies, marked at the right. The analysis window "
                 "spreads onsets by about 20&nbsp;ms.",
                 heard_html(digest)) +
         "</div>\n";
}

}  // namespace

Result<void> write_report(const Digest& digest, const PageVideo& video,
                          const std::function<void(std::string_view)>& out) {
  const session::Run& run = digest.run();
  const std::string title = run.title.empty() ? "Session" : run.title;
  out(page_head(title + " – Intaglio", report_css));
  out(fmt::format("<header>\n<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", escape_html(title),
                  summary_sentence(digest)));
  if (const std::string note = scene::cue_note(run.cues); !note.empty())
    out(fmt::format("<p class=\"note\">{}.</p>\n", escape_html(note)));
  if (auto written = write_video(video, out); !written) return written;
  out(key_frame_strip(run) + "</header>\n");
  out(section("seen", "Seen",
              "The height map from above, with the paths of balls and pen, dark at the start and bright at "
              "the end.",
              seen_html(digest)));
  out(tracks(digest));
  out(section("agreement", "Agreement", "How well the senses agree in this recording.",
              agreement_html(measure_agreement(digest))));
  out(section("cost", "Cost and identity", "Resources used, and the hashes that identify the run.",
              "<div class=\"wide\">" + cost_table(run) + "</div>\n<div class=\"wide\">" + voice_table(run) +
                  "</div>\n<div class=\"wide\">" + run_table(digest) + "</div>\n"));
  out(fmt::format("</main>\n<script>{}</script>\n</body>\n</html>\n", report_script));
  return {};
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

std::string cost_table(const session::Run& run) {
  std::string html = table_head(
      "Cost of each sense, in CPU time of its thread. The real-time factor is simulated time over CPU "
      "time: above 1 is faster than real time.",
      header_cell("Sense") + header_cell("Step") + figure_header_cell("Steps") +
          figure_header_cell("Median, µs") + figure_header_cell("99 %, µs") + figure_header_cell("All, s") +
          figure_header_cell("Real-time factor"));
  for (const session::SenseCost& cost : run.costs) {
    const double simulated = cost.step_seconds * double(cost.steps);
    html += fmt::format("<tr><th scope=\"row\">{}</th>", escape_html(cost.sense)) +
            cell(escape_html(cost.step)) + figure(std::to_string(cost.steps)) +
            figure(format_number(cost.median_us)) + figure(format_number(cost.p99_us)) +
            figure(format_number(cost.total_s, 3)) +
            figure(cost.total_s > 0 ? format_number(simulated / cost.total_s) : "–") + "</tr>\n";
  }
  if (run.costs.empty()) html += "<tr><td colspan=\"7\">–</td></tr>\n";
  return html + "</tbody></table>\n";
}

std::string run_table(const Digest& digest) {
  const session::Run& run = digest.run();
  std::string html =
      "<table>\n<caption>The run. Two runs of one scene have the same hashes.</caption>\n<tbody>\n";
  html += figure_row("Simulated time, s", format_number(run.duration, 2));
  html += figure_row("Wall time, s", format_number(run.wall_s, 2));
  html += figure_row("Modal analysis, CPU s", format_number(run.bake_s, 2));
  html += figure_row("Memory of the surface", format_bytes(run.surface_bytes));
  html += figure_row("Peak memory of the process", format_bytes(run.peak_memory_bytes));
  html += figure_row("Contact events", std::to_string(digest.contacts().count()));
  html += figure_row("Momentum residual, N s", format_number(run.momentum_residual));
  html += figure_row("Hash of the events", fmt::format("<code>{}</code>", format_hex(run.event_hash)));
  html += figure_row("Hash of the audio", fmt::format("<code>{}</code>", format_hex(run.audio_hash)));
  return html + "</tbody></table>\n";
}

std::string voice_table(const session::Run& run) {
  std::string html = table_head("Voices: what was baked for each body.",
                                header_cell("Body") + header_cell("Material") + figure_header_cell("Modes") +
                                    header_cell("Lowest frequencies, Hz") + header_cell("T60, ms"));
  for (const scene::Voice& voice : run.voices) {
    const auto [shortest, longest] = std::minmax_element(voice.t60.begin(), voice.t60.end());
    html += fmt::format("<tr><th scope=\"row\"><span class=\"dot {}\"></span>{}</th>",
                        body_css_class(voice.body, run.pen), escape_html(voice.name)) +
            cell(escape_html(voice.material)) + figure(std::to_string(voice.frequencies.size())) +
            cell(lowest_text(voice.frequencies)) +
            cell(voice.t60.empty() ? "–" : range_text(1e3 * *shortest, 1e3 * *longest)) + "</tr>\n";
  }
  if (run.voices.empty()) html += "<tr><td colspan=\"5\">–</td></tr>\n";
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

// Where it touches, and a margin above.
Range shown_heights(const PenDigest& pen) {
  const Range range = pen.heights.range();
  return {range.low - 0.1 * range.size(), range.high + 0.4 * range.size()};
}

void draw_force(SvgPlot& plot, const Digest& digest, const Axis& y) {
  plot.envelope(y, digest.pen().force, "area pen");
  plot.curve(y, digest.pen().force, "curve pen");
  plot.y_axis(digest.time(), y, "force, N", 3);
  const double limit = haptics::GuardLimits{}.peak_force;
  if (limit > y.values().high) return;
  plot.line(track_area.low, y(limit), track_area.high, y(limit), "limit");
  plot.text(track_area.high + 14, y(limit) + 4, format_number(limit, 1) + " N, the guard", "tick");
}

// Limits the axis for balls that have fallen off.
Range height_range(const Digest& digest) {
  Range range = digest.heights().range();
  const double relief = digest.run().surface ? digest.run().surface->max_depth() : 0;
  range.low = std::max(range.low, -std::max({0.5 * range.high, 1.5 * relief, 0.01}));
  return range.padded(0.06);
}

// Vertical lines at the strongest impacts, through all panels of a track.
void draw_impacts(SvgPlot& plot, const Digest& digest, double top, double bottom) {
  const Axis& time = digest.time();
  for (const Impact& impact : strongest(digest.contacts().impacts(), 40, 0.03)) {
    if (impact.time < 0 || impact.time > time.values().high) continue;
    plot.line(time(impact.time), top, time(impact.time), bottom,
              fmt::format("impact {}", body_css_class(impact.body, digest.run().pen)));
  }
}

}  // namespace

std::string felt_html(const Digest& digest) {
  const PenDigest& pen = digest.pen();
  if (pen.ticks == 0) return "<p>No pen took part.</p>\n";
  const double most = pen.forces.range({0, 1}).high, limit = haptics::GuardLimits{}.peak_force;
  const Axis& time = digest.time();
  const Axis height(shown_heights(pen), {166, 10});
  const Axis force({0, most > 0.75 * limit && most < 1.05 * limit ? 1.12 * limit : 1.1 * most}, {270, 186});
  SvgPlot plot(track_width, force.units().low + track_axis_height, "plot track", "Felt",
               "The height of the pen’s tip and of the surface under it, and the force on the hand, over "
               "time. Shaded where the pen touches.");
  for (const TimeSpan& touch : pen.touches.spans()) {
    plot.rectangle(time(touch.begin), height.units().high, time(touch.end) - time(touch.begin),
                   force.units().low - height.units().high, "touch");
  }
  plot.y_axis(time, height, "height, mm", 4);
  draw_impacts(plot, digest, height.units().high, force.units().low);
  plot.curve(height, pen.surface, "curve floor");
  plot.curve(height, pen.tip, "curve pen");
  add_legend(plot, height, 0, "pen’s tip", "pen");
  add_legend(plot, height, 1, "surface", "floor");
  draw_force(plot, digest, force);
  plot.x_axis(time, force.units().low, "s", track_time_ticks);
  return plot.finish();
}

std::string moved_html(const Digest& digest) {
  if (digest.balls().empty()) return "<p>No ball took part.</p>\n";
  const Axis& time = digest.time();
  const Range heights = height_range(digest);
  const double unit = heights.size() < 0.1 ? 1e3 : 1;  // a metre
  const Axis height({heights.low * unit, heights.high * unit}, {140, 10});
  const Axis speed({0, 1.08 * digest.speeds().range({0, 1}).high}, {244, 160});
  SvgPlot plot(track_width, speed.units().low + track_axis_height, "plot track", "Moved",
               "The height of each ball’s lowest point above the base plane, and its speed, over time.");
  plot.y_axis(time, height, unit > 1 ? "height, mm" : "height, m", 4);
  plot.y_axis(time, speed, "speed, m/s", 3);
  draw_impacts(plot, digest, height.units().high, speed.units().low);
  plot.line(track_area.low, height(0), track_area.high, height(0), "curve floor thin");
  add_legend(plot, height, 0, "base plane", "floor thin");
  int row = 1;
  for (const BallDigest& ball : digest.balls()) {
    const std::string colour = body_css_class(ball.body, digest.run().pen);
    plot.curve(height, ball.height.scaled(unit), "curve " + colour);
    plot.curve(speed, ball.speed, "curve " + colour);
    if (row < 7) add_legend(plot, height, row++, body_name(digest.run(), ball.body), colour);
  }
  plot.x_axis(time, speed.units().low, "s", track_time_ticks);
  return plot.finish();
}

namespace {

constexpr double balls_y = 52, pen_y = 62, spectrogram_top = 80, spectrogram_bottom = 360, wave_top = 374,
                 wave_bottom = 434;
constexpr double shown_decibels = 80;

// Contact marks: a triangle for each impact of a ball, a bar while the pen touches.
void draw_contacts(SvgPlot& plot, const Digest& digest) {
  const Axis& time = digest.time();
  const session::Run& run = digest.run();
  const std::vector<Impact> impacts = strongest(digest.contacts().impacts(), 400, 0);
  double most = 0;
  for (const Impact& impact : impacts) most = std::max(most, impact.impulse);
  plot.line(track_area.low, balls_y, track_area.high, balls_y, "grid");
  for (const Impact& impact : impacts) {
    if (impact.time < 0 || impact.time > time.values().high) continue;
    const std::string tip = fmt::format("{} at {} s: {} N s", body_name(run, impact.body),
                                        format_number(impact.time, 3), format_number(impact.impulse));
    plot.triangle(time(impact.time), balls_y, most > 0 ? 5 + 19 * std::sqrt(impact.impulse / most) : 5,
                  fmt::format("mark {}", body_css_class(impact.body, run.pen)), tip);
  }
  for (const TimeSpan& touch : digest.pen().touches.spans()) {
    plot.rectangle(time(touch.begin), pen_y, std::max(1.0, time(touch.end) - time(touch.begin)), 8,
                   "mark pen");
  }
  if (!run.balls.empty()) plot.text(track_area.low - 8, balls_y - 4, "impacts", "tick", TextAnchor::end);
  if (digest.pen().ticks > 0) plot.text(track_area.low - 8, pen_y + 8, "pen", "tick", TextAnchor::end);
}

// A column of ticks right of the spectrogram for each voice, at its baked frequencies.
void draw_modes(SvgPlot& plot, const session::Run& run, const Axis& hz) {
  const double pitch = std::min(18.0, 110.0 / double(std::max<std::size_t>(run.voices.size(), 1)));
  double x = track_area.high + 10;
  for (const scene::Voice& voice : run.voices) {
    const std::string colour = body_css_class(voice.body, run.pen);
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

void draw_colour_bar(SvgPlot& plot, double floor_db, double top_db) {
  const double left = track_area.high + 12, width = 88, y = wave_top + 14;
  Image8 bar(64, 1, 3);
  for (int x = 0; x < bar.width; ++x) {
    const Rgb colour = magma((x + 0.5) / bar.width);
    for (int c = 0; c < 3; ++c) bar.at(x, 0, c) = colour[std::size_t(c)];
  }
  plot.text(left, y - 6, "power, dB", "tick");
  plot.image(left, y, width, 10, data_uri(bar));
  plot.text(left, y + 25, format_number(floor_db, 0), "tick");
  plot.text(left + width, y + 25, format_number(top_db, 0), "tick", TextAnchor::end);
}

}  // namespace

std::string heard_html(const Digest& digest) {
  const SoundDigest& sound = digest.sound();
  if (sound.samples() == 0 || digest.run().sample_rate <= 0) return "<p>No sound was recorded.</p>\n";
  const Axis& time = digest.time();
  // The loudest bin at the top of the scale, in steps of 5 dB.
  const double top_db = 5 * std::ceil(level_db(double(sound.picture().loudest()), -60) / 5);
  const double floor_db = top_db - shown_decibels;
  const Axis hz({sound.view().low_hz, sound.view().high_hz}, {spectrogram_bottom, spectrogram_top},
                AxisScale::logarithmic);
  SvgPlot plot(track_width, wave_bottom + track_axis_height, "plot track", "Heard",
               "Contacts, spectrogram with the baked modal frequencies of each body at its right, and the "
               "waveform, over time.");
  draw_contacts(plot, digest);
  plot.image(track_area.low, spectrogram_top, track_area.size(), spectrogram_bottom - spectrogram_top,
             data_uri(sound.picture().image(floor_db, top_db)));
  plot.y_axis(time, hz, "frequency, Hz", 0);
  draw_modes(plot, digest.run(), hz);
  const Range range = sound.level().range({-1, 1});
  const double peak = std::max({std::abs(range.low), std::abs(range.high), 1e-3});
  const Axis level({-peak, peak}, {wave_bottom, wave_top});
  plot.y_axis(time, level, "wave", 4);
  plot.envelope(level, sound.wave(), "wave");
  draw_impacts(plot, digest, balls_y, wave_bottom);
  draw_colour_bar(plot, floor_db, top_db);
  plot.x_axis(time, wave_bottom, "s", track_time_ticks);
  return plot.finish();
}

}  // namespace intaglio::report
