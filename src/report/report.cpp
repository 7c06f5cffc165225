#include "report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "report/agreement.h"
#include "report/contacts.h"
#include "report/html.h"
#include "report/tracks.h"

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
      return "left flat";
    case Representation::normal:
      return "taken by its normals";
    case Representation::relief:
      return "taken as relief";
  }
  return "";
}

std::string who_text(const session::Recording& recording) {
  static constexpr std::array words = {"", "One ball", "Two balls", "Three balls", "Four balls"};
  const std::size_t balls = recording.balls.size();
  std::string who = balls < words.size() ? words[balls] : fmt::format("{} balls", balls);
  if (!recording.servo.empty()) who += who.empty() ? "A pen" : " and a pen";
  return who.empty() ? "Nothing" : who;
}

// What is shown, in one sentence.
std::string lead(const session::Recording& recording) {
  std::string where = "no surface";
  if (recording.surface) {
    const surface::Placement& placement = recording.surface->placement();
    where = fmt::format("a surface of {}&nbsp;m by {}&nbsp;m {}", number(placement.size_u()),
                        number(placement.size_v()), representation_text(recording.representation));
  }
  return fmt::format(
      "{} on {}, for {}&nbsp;s: one texture, seen at {}&nbsp;frames a second, felt at {}&nbsp;Hz, moved at "
      "{}&nbsp;Hz and heard at {}&nbsp;Hz.",
      who_text(recording), where, number(recording.duration, 1), recording.fps, recording.servo_rate,
      recording.physics_rate, recording.sample_rate);
}

// At most so many, evenly chosen.
std::string key_frame_strip(const session::Recording& recording) {
  const std::size_t shown = std::min(recording.key_frames.size(), most_key_frames);
  std::string html = "<ul class=\"strip\">\n";
  for (std::size_t k = 0; k < shown; ++k) {
    const session::KeyFrame& frame = recording.key_frames[k * recording.key_frames.size() / shown];
    if (frame.image.empty()) continue;
    const std::string time = number(frame.time, 2);
    html += fmt::format(
        "<li><figure><img alt=\"The scene at {0} s\" "
        "src=\"{1}\"><figcaption>{0}&nbsp;s</figcaption></figure></li>\n",
        time, data_uri(shrunk(frame.image, key_frame_width)));
  }
  // A list without items is not a list.
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
                 "The pen’s tip sinks a little into the surface it follows; the force is the spring’s "
                 "answer. Shaded: touching.",
                 felt_html(recording)) +
         section("moved", "Moved",
                 "The lowest point of each ball over the base plane, and its speed. Vertical lines mark the "
                 "strongest impacts.",
                 moved_html(recording)) +
         section("heard", "Heard",
                 "Each contact starts a streak below it. Streaks lie level with the modes baked for each "
                 "body, marked at the right. Spread by the window, they begin some 20&nbsp;ms early.",
                 heard_html(recording)) +
         "</div>\n";
}

}  // namespace

std::string report_html(const session::Recording& recording, std::span<const std::uint8_t> video_mp4) {
  const std::string title = recording.title.empty() ? "Session" : escaped(recording.title);
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\">\n<title>{0} – "
      "Intaglio</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n<header>\n<h1>{0}</h1>\n<p "
      "class=\"lead\">{2}</p>\n",
      title, report_css, lead(recording));
  html += picture(recording, video_mp4) + "</header>\n";
  html += section("seen", "Seen",
                  "The height map from above, with the ways that were taken over it, dark at the start and "
                  "bright at the end.",
                  seen_html(recording));
  html += tracks(recording);
  html += section("agreement", "Agreement",
                  "How far the senses tell the same story, computed from this recording.",
                  agreement_html(agreement_of(recording)));
  html += section("cost", "Cost and identity", "What it took, and what tells this run from another.",
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
std::string heading(std::string_view text) {
  return fmt::format("<th scope=\"col\">{}</th>", text);
}
std::string figure_heading(std::string_view text) {
  return fmt::format("<th scope=\"col\" class=\"figure\">{}</th>", text);
}
std::string opened(std::string_view caption, const std::string& headings) {
  return fmt::format("<table>\n<caption>{}</caption>\n<thead><tr>{}</tr></thead>\n<tbody>\n", caption,
                     headings);
}
std::string row(std::string_view name, std::string_view value) {
  return fmt::format("<tr><th scope=\"row\">{}</th>{}</tr>\n", name, figure(value));
}

// "10–13", or one number when both are the same.
std::string range_text(double low, double high) {
  const std::string a = number(low), b = number(high);
  return a == b ? a : a + " to " + b;
}

std::string lowest_text(const std::vector<double>& frequencies) {
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(frequencies.size(), 5); ++k)
    text += (k > 0 ? ", " : "") + number(frequencies[k], 0);
  return text.empty() ? "–" : text + (frequencies.size() > 5 ? ", …" : "");
}

}  // namespace

std::string cost_table(const session::Recording& recording) {
  std::string html = opened(
      "What each sense cost, in CPU time of its thread. The real-time factor is simulated time over CPU "
      "time: above 1 is faster than life.",
      heading("Sense") + heading("Step") + figure_heading("Steps") + figure_heading("Median, µs") +
          figure_heading("99 %, µs") + figure_heading("All, s") + figure_heading("Real-time factor"));
  for (const session::SenseCost& cost : recording.costs) {
    const double simulated = cost.step_seconds * static_cast<double>(cost.steps);
    html += fmt::format("<tr><th scope=\"row\">{}</th>", escaped(cost.sense)) + cell(escaped(cost.step)) +
            figure(std::to_string(cost.steps)) + figure(number(cost.median_us)) +
            figure(number(cost.p99_us)) + figure(number(cost.total_s, 3)) +
            figure(cost.total_s > 0 ? number(simulated / cost.total_s) : "–") + "</tr>\n";
  }
  if (recording.costs.empty()) html += "<tr><td colspan=\"7\">–</td></tr>\n";
  return html + "</tbody></table>\n";
}

std::string run_table(const session::Recording& recording) {
  std::string html =
      "<table>\n<caption>The run. Two runs of one scene have the same hashes.</caption>\n<tbody>\n";
  html += row("Simulated time, s", number(recording.duration, 2));
  html += row("Wall time, s", number(recording.wall_s, 2));
  html += row("Modal analysis, CPU s", number(recording.bake_s, 2));
  html += row("Memory of the surface", bytes_text(recording.surface_bytes));
  html += row("Peak memory of the process", bytes_text(recording.peak_memory_bytes));
  html += row("Contact events", std::to_string(recording.events.size()));
  html += row("Momentum not accounted for, N s", number(recording.momentum_residual));
  html += row("Hash of the events", fmt::format("<code>{}</code>", hex_text(recording.event_hash)));
  html += row("Hash of the audio", fmt::format("<code>{}</code>", hex_text(recording.audio_hash)));
  return html + "</tbody></table>\n";
}

std::string voice_table(const session::Recording& recording) {
  std::string html = opened("Voices: what was baked for each body.",
                            heading("Body") + heading("Material") + figure_heading("Modes") +
                                heading("Lowest frequencies, Hz") + heading("T60, ms"));
  for (const scene::Voice& voice : recording.voices) {
    const auto [shortest, longest] = std::minmax_element(voice.t60.begin(), voice.t60.end());
    html += fmt::format("<tr><th scope=\"row\"><span class=\"dot {}\"></span>{}</th>",
                        body_class(voice.body, recording.pen), escaped(voice.name)) +
            cell(escaped(voice.material)) + figure(std::to_string(voice.frequencies.size())) +
            cell(lowest_text(voice.frequencies)) +
            cell(voice.t60.empty() ? "–" : range_text(1e3 * *shortest, 1e3 * *longest)) + "</tr>\n";
  }
  if (recording.voices.empty()) html += "<tr><td colspan=\"5\">–</td></tr>\n";
  return html + "</tbody></table>\n";
}

}  // namespace intaglio::report
