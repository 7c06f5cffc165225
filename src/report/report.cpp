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
std::string row(std::string_view name, std::string_view value) {
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
  html += row("Simulated time, s", format_number(recording.duration, 2));
  html += row("Wall time, s", format_number(recording.wall_s, 2));
  html += row("Modal analysis, CPU s", format_number(recording.bake_s, 2));
  html += row("Memory of the surface", format_bytes(recording.surface_bytes));
  html += row("Peak memory of the process", format_bytes(recording.peak_memory_bytes));
  html += row("Contact events", std::to_string(recording.events.size()));
  html += row("Momentum residual, N s", format_number(recording.momentum_residual));
  html += row("Hash of the events", fmt::format("<code>{}</code>", format_hex(recording.event_hash)));
  html += row("Hash of the audio", fmt::format("<code>{}</code>", format_hex(recording.audio_hash)));
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

}  // namespace intaglio::report
