#include "intaglio/session/report_tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "intaglio/session/report_contacts.h"
#include "intaglio/session/report_text.h"

namespace intaglio::session {

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

std::string cost_table(const Recording& recording) {
  std::string html = opened(
      "What each sense cost, in CPU time of its thread. The real-time factor is simulated time over CPU "
      "time: above 1 is faster than life.",
      heading("Sense") + heading("Step") + figure_heading("Steps") + figure_heading("Median, µs") +
          figure_heading("99 %, µs") + figure_heading("All, s") + figure_heading("Real-time factor"));
  for (const SenseCost& cost : recording.costs) {
    const double simulated = cost.step_seconds * static_cast<double>(cost.steps);
    html += fmt::format("<tr><th scope=\"row\">{}</th>", escaped(cost.sense)) + cell(escaped(cost.step)) +
            figure(std::to_string(cost.steps)) + figure(number(cost.median_us)) +
            figure(number(cost.p99_us)) + figure(number(cost.total_s, 3)) +
            figure(cost.total_s > 0 ? number(simulated / cost.total_s) : "–") + "</tr>\n";
  }
  if (recording.costs.empty()) html += "<tr><td colspan=\"7\">–</td></tr>\n";
  return html + "</tbody></table>\n";
}

std::string run_table(const Recording& recording) {
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

std::string voice_table(const Recording& recording) {
  std::string html = opened("Voices: what was baked for each body.",
                            heading("Body") + heading("Material") + figure_heading("Modes") +
                                heading("Lowest frequencies, Hz") + heading("T60, ms"));
  for (const Voice& voice : recording.voices) {
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

}  // namespace intaglio::session
