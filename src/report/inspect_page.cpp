#include "report/inspect_page.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text.h"
#include "intaglio/error.h"
#include "report/html.h"
#include "report/svg_plot.h"

namespace intaglio::report {

using surface::Inspection;

namespace {

constexpr const char* page_css =
    ".maps{display:grid;grid-template-columns:repeat(auto-fit,minmax(220px,1fr));gap:1.2rem}"
    ".maps img{width:100%;display:block;border-radius:4px}.maps figure{margin:0}"
    ".bar{fill:#4477aa}.advice{font-size:1.15em}.warning{color:#b3261e}";

std::string list(const std::vector<std::string>& lines) {
  std::vector<std::string> items;
  for (const std::string& line : lines) items.push_back(json_quoted(line));
  return fmt::format("[{}]", fmt::join(items, ", "));
}

std::string green_text(const Inspection& i) {
  return i.report.green == surface::Green::plus_y ? "+Y" : "-Y";
}

std::string polarity_text(const Inspection& i) {
  if (!i.has_height) return "none";
  return i.report.polarity == surface::Polarity::height ? "height" : "depth";
}

std::string file_text(const std::filesystem::path& path) {
  return path.empty() ? "–" : escape_html(path.filename().string());
}

std::string slope_plot(const Inspection& inspection) {
  SvgPlot plot(660, 220, "plot", "Slopes", "Fraction of the surface by slope, in steps of five degrees");
  const Axis x({0, 90}, {60, 560});
  const double most =
      std::max(0.01, *std::max_element(inspection.slope_histogram.begin(), inspection.slope_histogram.end()));
  const Axis y({0, 100 * most}, {180, 20});
  plot.y_axis(x, y, "% of the surface", 4);
  for (std::size_t k = 0; k < inspection.slope_histogram.size(); ++k) {
    const double left = x(double(k) * Inspection::bin_degrees) + 1;
    const double right = x(double(k + 1) * Inspection::bin_degrees) - 1;
    const double top = y(100 * inspection.slope_histogram[k]);
    plot.rectangle(left, top, right - left, 180 - top, "bar");
  }
  plot.x_axis(x, 180, "degrees", 9);
  return plot.finish();
}

std::string text_row(std::string_view name, const std::string& value) {
  return table_row(name, fmt::format("<td>{}</td>", value));
}

std::string table(const Inspection& i) {
  const surface::ImportReport& r = i.report;
  std::string out = "<table><caption>What was found</caption>\n";
  out += text_row("Size", fmt::format("{} × {} texels", i.width, i.height));
  out += text_row("Normals from",
                  fmt::format("{}{}", file_text(r.normal_file),
                              r.normal_bits != 0 ? fmt::format(", {} bits", r.normal_bits) : ""));
  out +=
      text_row("Height from",
               fmt::format("{}{}{}", file_text(r.height_file), r.height_channel == 3 ? ", alpha channel" : "",
                           r.height_bits != 0 ? fmt::format(", {} bits", r.height_bits) : ""));
  out += text_row("Green", i.has_normals ? (green_text(i) +
                                            (r.detected_green ? "" : ", from the file name (not detectable)"))
                                         : "–");
  out += text_row("White means", i.has_height ? (polarity_text(i) == "height" ? "high" : "deep") : "–");
  out += text_row("Rows of the height", r.rows_flipped ? "flipped relative to the normals" : "in order");
  out += text_row("Correlation",
                  i.has_normals && i.has_height
                      ? fmt::format("{} (along u {}, along v {})", format_number(r.correlation, 2),
                                    format_number(r.correlation_u, 2), format_number(r.correlation_v, 2))
                      : "–");
  out += text_row("Full depth", fmt::format("{} % of the side{}", format_number(100 * i.depth_fraction, 2),
                                            r.implied_depth > 0 ? ", implied by the normals" : ""));
  out += text_row("RMS slope", format_number(i.rms_slope, 3));
  out += text_row("Steep (over 45°)", format_number(100 * i.steep_fraction, 2) + " %");
  out += text_row("Near-vertical (over 70°)", format_number(100 * i.near_vertical_fraction, 2) + " %");
  out += text_row("Levels of height", i.height_levels > 0
                                          ? fmt::format("{}; one level is a slope of {}", i.height_levels,
                                                        format_number(i.terrace_slope, 3))
                                          : "–");
  out += text_row("Non-integrable slope (curl)", i.has_normals ? format_number(100 * r.curl, 1) + " %" : "–");
  return out + "</table>\n";
}

std::string figure(const char* caption, const Image8& image) {
  return fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n", caption,
                     data_uri(image));
}

}  // namespace

std::string inspection_json(const Inspection& i) {
  const surface::ImportReport& r = i.report;
  std::string out = "{\n";
  const auto add = [&](const char* key, const std::string& value) {
    out += fmt::format("  \"{}\": {},\n", key, value);
  };
  add("width", std::to_string(i.width));
  add("height", std::to_string(i.height));
  add("normal_file", r.normal_file.empty() ? "null" : json_quoted(r.normal_file.string()));
  add("height_file", r.height_file.empty() ? "null" : json_quoted(r.height_file.string()));
  add("colour_file", r.colour_file.empty() ? "null" : json_quoted(r.colour_file.string()));
  add("normal_bits", std::to_string(r.normal_bits));
  add("height_bits", std::to_string(r.height_bits));
  add("green", i.has_normals ? json_quoted(green_text(i)) : "null");
  add("green_detected", r.detected_green ? "true" : "false");
  add("polarity", json_quoted(polarity_text(i)));
  add("rows_differ", r.rows_flipped ? "true" : "false");
  add("correlation", fmt::format("{:.6g}", r.correlation));
  add("correlation_u", fmt::format("{:.6g}", r.correlation_u));
  add("correlation_v", fmt::format("{:.6g}", r.correlation_v));
  add("agrees", i.has_normals && i.has_height ? (r.detected_green ? "true" : "false") : "null");
  add("implied_depth_fraction", fmt::format("{:.6g}", r.implied_depth));
  add("depth_fraction", fmt::format("{:.6g}", i.depth_fraction));
  add("rms_slope", fmt::format("{:.6g}", i.rms_slope));
  add("steep_fraction", fmt::format("{:.6g}", i.steep_fraction));
  add("near_vertical_fraction", fmt::format("{:.6g}", i.near_vertical_fraction));
  add("slope_histogram_degrees", std::to_string(Inspection::bin_degrees));
  add("slope_histogram", fmt::format("[{:.6g}]", fmt::join(i.slope_histogram, ", ")));
  add("height_levels", std::to_string(i.height_levels));
  add("terrace_slope", fmt::format("{:.6g}", i.terrace_slope));
  add("curl", fmt::format("{:.6g}", r.curl));
  add("clamped_normals", fmt::format("{:.6g}", r.clamped_normals));
  add("representation", json_quoted(i.representation));
  add("reason", json_quoted(i.reason));
  add("notes", list(i.notes));
  out += fmt::format("  \"warnings\": {}\n}}\n", list(i.warnings));
  return out;
}

std::string inspection_html(const Inspection& inspection, const std::string& title) {
  std::string out = page_head(title, std::string(report_css) + page_css);
  out += fmt::format("<h1>{}</h1>\n", escape_html(title));
  out += fmt::format("<p class=\"advice\">Recommended representation: <strong>{}</strong>. {}.</p>\n",
                     inspection.representation, escape_html(inspection.reason));
  for (const std::string& warning : inspection.warnings)
    out += fmt::format("<p class=\"warning\">{}.</p>\n", escape_html(warning));
  out += "<section aria-labelledby=\"maps\">\n<h2 id=\"maps\">Interpreted maps</h2>\n<div class=\"maps\">\n";
  out += figure("Lit from the upper left", inspection.preview) + figure("Colour", inspection.colour) +
         figure("Height, white = high", inspection.height_map) +
         figure("Normals, green +Y", inspection.normal_map);
  out += "</div>\n</section>\n<section aria-labelledby=\"slopes\">\n<h2 id=\"slopes\">Slopes</h2>\n" +
         slope_plot(inspection) + "</section>\n";
  out += "<section aria-labelledby=\"found\">\n<h2 id=\"found\">In numbers</h2>\n" + table(inspection);
  for (const std::string& line : inspection.notes) out += fmt::format("<p>{}.</p>\n", escape_html(line));
  return out + "</section>\n" + std::string(page_end);
}

}  // namespace intaglio::report
