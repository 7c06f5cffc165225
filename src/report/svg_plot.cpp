#include "report/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "report/html.h"

namespace intaglio::report {

namespace {

template <class... Values>
bool finite(Values... values) {
  return (std::isfinite(values) && ...);
}

std::string_view anchor_name(TextAnchor anchor) {
  switch (anchor) {
    case TextAnchor::start:
      return "start";
    case TextAnchor::middle:
      return "middle";
    case TextAnchor::end:
      return "end";
  }
  return "start";
}

std::string title_element(std::string_view tooltip) {
  return tooltip.empty() ? std::string() : fmt::format("<title>{}</title>", escape_html(tooltip));
}

// Decimals needed to distinguish ticks `spacing` apart.
int decimals_for(double spacing) {
  if (!(spacing > 0) || !std::isfinite(spacing)) return 0;
  return std::clamp(int(std::ceil(-std::log10(spacing) - 1e-9)), 0, 6);
}

int decimals_of(const Axis& axis, const std::vector<double>& ticks) {
  if (axis.scale() == AxisScale::logarithmic) return 0;
  return decimals_for(ticks.size() > 1 ? ticks[1] - ticks[0] : axis.values().size());
}

// Whether a column of a run or one of its neighbours lies within the axis; farther outside it would draw a
// line along the edge.
bool near_axis(const std::vector<DrawnCurve::Column>& run, std::size_t k, const Axis& y) {
  const Range& range = y.values();
  for (std::size_t j = k > 0 ? k - 1 : 0; j <= std::min(k + 1, run.size() - 1); ++j) {
    const auto [least, most] = std::minmax(run[j].first_value, run[j].second_value);
    if (most >= range.low && least <= range.high) return true;
  }
  return false;
}

double clipped(const Axis& y, double value) {
  return y(std::clamp(value, y.values().low, y.values().high));
}

}  // namespace

SvgPlot::SvgPlot(double width, double height, std::string_view classes, std::string_view title,
                 std::string_view description) {
  out_ = fmt::format("<svg class=\"{}\" viewBox=\"0 0 {:.6g} {:.6g}\" role=\"img\" aria-label=\"{}. {}\">\n",
                     classes, width, height, escape_html(title), escape_html(description));
}

void SvgPlot::line(double x0, double y0, double x1, double y1, std::string_view classes) {
  if (!finite(x0, y0, x1, y1)) return;
  out_ += fmt::format("<line class=\"{}\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>\n",
                      classes, x0, y0, x1, y1);
}

void SvgPlot::rectangle(double x, double y, double width, double height, std::string_view classes) {
  if (!finite(x, y, width, height) || width < 0 || height < 0) return;
  out_ += fmt::format("<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n",
                      classes, x, y, width, height);
}

void SvgPlot::circle(double x, double y, double radius, std::string_view classes, std::string_view tooltip) {
  if (!finite(x, y, radius)) return;
  out_ += fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.2f}\">{}</circle>\n", classes,
                      x, y, radius, title_element(tooltip));
}

void SvgPlot::triangle(double x, double y, double size, std::string_view classes, std::string_view tooltip) {
  if (!finite(x, y, size)) return;
  out_ += fmt::format("<path class=\"{}\" d=\"M{:.2f} {:.2f}l{:.2f} {:.2f}h{:.2f}z\">{}</path>\n", classes, x,
                      y, -0.42 * size, -size, 0.84 * size, title_element(tooltip));
}

void SvgPlot::text(double x, double y, std::string_view text, std::string_view classes, TextAnchor anchor) {
  if (!finite(x, y)) return;
  out_ += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", classes,
                      x, y, anchor_name(anchor), escape_html(text));
}

void SvgPlot::turned_text(double x, double y, double degrees, std::string_view text, std::string_view classes,
                          TextAnchor anchor) {
  if (!finite(x, y)) return;
  out_ += fmt::format(
      "<text class=\"{}\" transform=\"translate({:.1f} {:.1f}) rotate({:.0f})\" "
      "text-anchor=\"{}\">{}</text>\n",
      classes, x, y, -degrees, anchor_name(anchor), escape_html(text));
}

void SvgPlot::image(double x, double y, double width, double height, std::string_view uri) {
  out_ += fmt::format(
      "<image x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" preserveAspectRatio=\"none\" "
      "href=\"{}\"/>\n",
      x, y, width, height, uri);
}

void SvgPlot::polyline(std::span<const double> xs, std::span<const double> ys, std::string_view classes,
                       std::string_view style) {
  std::string points;
  for (std::size_t k = 0; k < xs.size(); ++k) {
    if (finite(xs[k], ys[k])) fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} ", xs[k], ys[k]);
  }
  if (points.empty()) return;
  out_ += fmt::format("<polyline class=\"{}\" style=\"{}\" points=\"{}\"/>\n", classes, style, points);
}

void SvgPlot::curve(const Axis& y, const DrawnCurve& curve, std::string_view classes) {
  std::string path;
  for (const std::vector<DrawnCurve::Column>& run : curve.runs()) {
    char command = 'M';
    for (std::size_t k = 0; k < run.size(); ++k) {
      const DrawnCurve::Column& column = run[k];
      if (!near_axis(run, k, y)) {
        command = 'M';
        continue;
      }
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", command, column.first_x,
                     clipped(y, column.first_value));
      command = 'L';
      if (column.second_x > column.first_x) {
        fmt::format_to(std::back_inserter(path), "L{:.1f} {:.1f}", column.second_x,
                       clipped(y, column.second_value));
      }
    }
  }
  if (!path.empty()) out_ += fmt::format("<path class=\"{}\" d=\"{}\"/>\n", classes, path);
}

void SvgPlot::envelope(const Axis& y, const DrawnCurve& curve, std::string_view classes) {
  std::string path;
  for (const std::vector<DrawnCurve::Column>& run : curve.runs()) {
    char command = 'M';
    for (const DrawnCurve::Column& column : run) {
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", command, column.first_x,
                     clipped(y, std::max(column.first_value, column.second_value)));
      command = 'L';
    }
    for (auto column = run.rbegin(); column != run.rend(); ++column) {
      fmt::format_to(std::back_inserter(path), "L{:.1f} {:.1f}", column->first_x,
                     clipped(y, std::min(column->first_value, column->second_value)));
    }
    if (!run.empty()) path += 'z';
  }
  if (!path.empty()) out_ += fmt::format("<path class=\"{}\" d=\"{}\"/>\n", classes, path);
}

void SvgPlot::y_axis(const Axis& x, const Axis& y, std::string_view label, int tick_count) {
  const double left = x.units().low, right = x.units().high;
  const std::vector<double> ticks = y.ticks(tick_count);
  const int decimals = decimals_of(y, ticks);
  for (const double tick : ticks) {
    line(left, y(tick), right, y(tick), "grid");
    const bool kilo = y.scale() == AxisScale::logarithmic && tick >= 1000;
    text(left - 8, y(tick) + 4, kilo ? format_number(tick / 1000, 0) + "k" : format_number(tick, decimals),
         "tick", TextAnchor::end);
  }
  rectangle(left, y.units().high, right - left, y.units().low - y.units().high, "frame");
  turned_text(left - 54, 0.5 * (y.units().low + y.units().high), 90, label, "label", TextAnchor::middle);
}

void SvgPlot::x_axis(const Axis& x, double bottom, std::string_view unit, int tick_count) {
  const std::vector<double> ticks = x.ticks(tick_count);
  const int decimals = decimals_of(x, ticks);
  for (const double tick : ticks) {
    line(x(tick), bottom, x(tick), bottom + 5, "axis");
    text(x(tick), bottom + 19, format_number(tick, decimals), "tick", TextAnchor::middle);
  }
  text(x.units().high + 20, bottom + 19, unit, "tick");
}

std::string SvgPlot::finish() {
  return std::move(out_) + "</svg>\n";
}

namespace {

using Linear = std::array<double, 3>;

// NaN becomes 0.
double clamped(double t) {
  return t > 0 ? std::min(t, 1.0) : 0.0;
}

std::uint8_t byte(double fraction) {
  return std::uint8_t(std::lround(255 * clamped(fraction)));
}

}  // namespace

Rgb magma(double t) {
  static constexpr std::array<Linear, 7> coefficients = {{
      {-0.002136485053939582, -0.000749655052795221, -0.005386127855323933},
      {0.2516605407371642, 0.6775232436837668, 2.494026599312351},
      {8.353717279216625, -3.577719514958484, 0.3144679030132573},
      {-27.66873308576866, 14.26473078096533, -13.64921318813922},
      {52.17613981234068, -27.94360607168351, 12.94416944238394},
      {-50.76852536473588, 29.04658282127291, 4.23415299384598},
      {18.65570506591883, -11.48977351997711, -5.601961508734096},
  }};
  t = clamped(t);
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    double value = 0;
    for (auto k = coefficients.rbegin(); k != coefficients.rend(); ++k) value = value * t + (*k)[c];
    colour[c] = byte(value);
  }
  return colour;
}

Rgb stone(double t) {
  static constexpr Linear low = {0.18, 0.15, 0.13}, high = {0.58, 0.54, 0.49};
  t = clamped(t);
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = byte(low[c] + t * (high[c] - low[c]));
  return colour;
}

}  // namespace intaglio::report
