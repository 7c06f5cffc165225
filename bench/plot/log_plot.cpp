#include "bench/plot/log_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/output_files.h"
#include "report/svg_plot.h"

namespace intaglio::bench {

namespace {

using namespace report;

constexpr double panel_width = 330, panel_height = 300, left = 62, top = 56, right_gap = 18, below = 52;
constexpr double key_height = 22;
constexpr std::size_t per_row = 3, keys_per_row = 4;

constexpr const char* style =
    "<style>text{font:12px system-ui,sans-serif;fill:#333}.title{font-size:14px;font-weight:600}"
    ".head{font-size:16px;font-weight:600}.grid{stroke:#e4e4e4}.frame{fill:none;stroke:#999}"
    ".limit{stroke:#555;stroke-dasharray:5 4}polyline{fill:none;stroke-width:2}"
    ".s0{stroke:#c0392b}.s1{stroke:#2c3e50}.s2{stroke:#2980b9}.s3{stroke:#27ae60}.s4{stroke:#e67e22}"
    ".s5{stroke:#8e44ad}.s6{stroke:#16a085}.s7{stroke:#7f8c8d}circle{stroke-width:1.5;fill:#fff}</style>\n"
    "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";

struct Points {
  std::vector<double> xs, ys;
};

Points positive(const Series& series) {
  Points out;
  for (std::size_t k = 0; k < series.xs.size(); ++k) {
    if (!(series.xs[k] > 0) || !(series.ys[k] > 0)) continue;
    out.xs.push_back(series.xs[k]);
    out.ys.push_back(series.ys[k]);
  }
  return out;
}

// Whole decades would waste half of a panel: bounds with some space beside the data. At least a factor of
// eight, so that what hardly changes looks so.
Range spaced(const Extent& extent) {
  const Range range = extent.range({1, 10});
  const double spare = std::max(1.3, std::sqrt(8 * range.low / range.high));
  return {range.low / spare, range.high * spare};
}

std::string short_number(double value) {
  if (value >= 1e6) return fmt::format("{:g}M", value / 1e6);
  if (value >= 1e3) return fmt::format("{:g}k", value / 1e3);
  return fmt::format("{:g}", value);
}

// Ticks of an axis, only the decades where all would be too many.
std::vector<double> sparse_ticks(const Axis& axis) {
  std::vector<double> ticks = axis.ticks(0);
  if (ticks.size() > 6)
    std::erase_if(ticks, [](double t) { return std::abs(std::remainder(std::log10(t), 1)) > 1e-9; });
  return ticks;
}

class Page {
 public:
  Page(const std::string& title, const std::vector<Panel>& panels)
      : rows_((panels.size() + per_row - 1) / per_row),
        columns_(std::min(panels.size(), per_row)),
        names_(names_of(panels)),
        width_(double(columns_) * panel_width + 10),
        height_(double(rows_) * (panel_height + below) + key_rows() * key_height + 10),
        plot_(width_, height_, "plot", title, "Plots with logarithmic axes") {
    plot_.text(left, 24, title, "head");
    for (std::size_t k = 0; k < panels.size(); ++k)
      draw(panels[k], double(k % per_row) * panel_width, double(k / per_row) * (panel_height + below));
    draw_key();
  }

  std::string finish() {
    std::string out = plot_.finish();
    const std::size_t open = out.find("<svg ") + 5, end = out.find('>') + 2;
    out.insert(end, style);
    out.insert(open, fmt::format("xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" ",
                                 width_, height_));
    return out;
  }

 private:
  static std::vector<std::string> names_of(const std::vector<Panel>& panels) {
    std::vector<std::string> names;
    for (const Panel& panel : panels) {
      for (const Series& series : panel.series) {
        if (std::find(names.begin(), names.end(), series.name) == names.end()) names.push_back(series.name);
      }
    }
    return names;
  }
  double key_rows() const { return std::ceil(double(names_.size()) / double(keys_per_row)); }
  std::string colour(const std::string& name) const {
    const auto at = std::find(names_.begin(), names_.end(), name) - names_.begin();
    return fmt::format("s{}", at % 8);
  }

  void draw(const Panel& panel, double x0, double y0) {
    Extent across, up;
    for (const Series& series : panel.series) {
      const Points points = positive(series);
      for (const double x : points.xs) across.add(x);
      for (const double y : points.ys) up.add(y);
    }
    if (panel.limit > 0) up.add(panel.limit);
    if (panel.mark > 0) across.add(panel.mark);
    const Axis x(spaced(across), {x0 + left, x0 + panel_width - right_gap}, AxisScale::logarithmic);
    const Axis y(spaced(up), {y0 + panel_height, y0 + top}, AxisScale::logarithmic);
    frame(panel, x, y);
    draw_limits(panel, x, y);
    for (const Series& series : panel.series) {
      Points points = positive(series);
      for (double& value : points.xs) value = x(value);
      for (double& value : points.ys) value = y(value);
      plot_.polyline(points.xs, points.ys, colour(series.name));
      for (std::size_t k = 0; k < points.xs.size(); ++k)
        plot_.circle(points.xs[k], points.ys[k], 3, colour(series.name));
    }
  }
  void draw_limits(const Panel& panel, const Axis& x, const Axis& y) {
    if (panel.limit > 0) {
      const double at = y(panel.limit);
      plot_.line(x.units().low, at, x.units().high, at, "limit");
      plot_.text(x.units().low + 6, at < y.units().high + 16 ? at + 14 : at - 5, panel.limit_name, "tick");
    }
    if (panel.mark > 0) {
      plot_.line(x(panel.mark), y.units().low, x(panel.mark), y.units().high, "limit");
      const bool on_the_right = x(panel.mark) > x.units().low + x.units().size() / 2;
      plot_.text(x(panel.mark) + (on_the_right ? -5 : 5), y.units().low - 6, panel.mark_name, "tick",
                 on_the_right ? TextAnchor::end : TextAnchor::start);
    }
  }
  void frame(const Panel& panel, const Axis& x, const Axis& y) {
    const double low = x.units().low, bottom = y.units().low;
    for (const double tick : sparse_ticks(y)) {
      plot_.line(low, y(tick), x.units().high, y(tick), "grid");
      plot_.text(low - 6, y(tick) + 4, short_number(tick), "tick", TextAnchor::end);
    }
    for (const double tick : sparse_ticks(x)) {
      plot_.line(x(tick), bottom, x(tick), y.units().high, "grid");
      plot_.text(x(tick), bottom + 16, short_number(tick), "tick", TextAnchor::middle);
    }
    plot_.rectangle(low, y.units().high, x.units().size(), bottom - y.units().high, "frame");
    plot_.text(low, y.units().high - 8, panel.title, "title");
    plot_.text(low + x.units().size() / 2, bottom + 34, panel.x_label, "label", TextAnchor::middle);
    plot_.turned_text(low - 44, (bottom + y.units().high) / 2, 90, panel.y_label, "label",
                      TextAnchor::middle);
  }
  void draw_key() {
    const double y0 = double(rows_) * (panel_height + below) + 4;
    const double step = (width_ - left) / double(std::min(keys_per_row, names_.size()));
    for (std::size_t k = 0; k < names_.size(); ++k) {
      const double x = left + double(k % keys_per_row) * step;
      const double y = y0 + double(k / keys_per_row) * key_height;
      plot_.polyline(std::vector{x, x + 24}, std::vector{y, y}, colour(names_[k]));
      plot_.text(x + 30, y + 4, names_[k], "label");
    }
  }

  std::size_t rows_, columns_;
  std::vector<std::string> names_;
  double width_, height_;
  SvgPlot plot_;
};

}  // namespace

Result<void> write_log_plot(const std::string& file, const std::string& title,
                            const std::vector<Panel>& panels) {
  OutputFiles files;
  if (auto written = files.write(file, Page(title, panels).finish()); !written) return written;
  return files.commit();
}

}  // namespace intaglio::bench
