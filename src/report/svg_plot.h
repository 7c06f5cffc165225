// Plots as inline SVG: marks on axes (report/axis.h), styled by CSS classes.
//
// Coordinates are in drawing units, y down. Non-finite values are skipped, so that any recording gives valid
// SVG. Colours come from the page's style sheet: one class names the kind of mark, another the body that it
// belongs to.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "report/axis.h"
#include "report/drawn_curve.h"

namespace intaglio::report {

enum class TextAnchor { start, middle, end };

class SvgPlot {
 public:
  // `title` and `description` are the accessible label.
  SvgPlot(double width, double height, std::string_view classes, std::string_view title,
          std::string_view description);

  void line(double x0, double y0, double x1, double y1, std::string_view classes);
  void rectangle(double x, double y, double width, double height, std::string_view classes);
  void circle(double x, double y, double radius, std::string_view classes, std::string_view tooltip = {});
  // A triangle that points down at (x, y).
  void triangle(double x, double y, double size, std::string_view classes, std::string_view tooltip = {});
  void text(double x, double y, std::string_view text, std::string_view classes,
            TextAnchor anchor = TextAnchor::start);
  // Text that reads upwards, or slants up to the right by `degrees`.
  void turned_text(double x, double y, double degrees, std::string_view text, std::string_view classes,
                   TextAnchor anchor);
  void image(double x, double y, double width, double height, std::string_view uri);
  void polyline(std::span<const double> xs, std::span<const double> ys, std::string_view classes,
                std::string_view style = {});

  // Clipped to the axes.
  void curve(const Axis& y, const DrawnCurve& curve, std::string_view classes);
  // The same as an area between the least and the greatest value of each unit of x.
  void envelope(const Axis& y, const DrawnCurve& curve, std::string_view classes);

  // Frame of a plot area with horizontal grid lines and labels at its left; `label` reads upwards beside
  // them.
  void y_axis(const Axis& x, const Axis& y, std::string_view label, int tick_count);
  // Ticks below `bottom`, their labels and the unit.
  void x_axis(const Axis& x, double bottom, std::string_view unit, int tick_count);

  // The whole element. Call once.
  std::string finish();

 private:
  std::string out_;
};

// Perceptually uniform colour scales: equal steps of a value are equal steps of lightness, in greyscale and
// for colour-blind readers, too.

using Rgb = std::array<std::uint8_t, 3>;  // sRGB

// The scale "magma" of Smith and van der Walt (matplotlib, 2015), black to pale yellow, for t in 0..1
// (clamped; not-a-number is 0). Within 3/255 of their table: sixth-degree fits by M. Zucker (2019, public
// domain).
Rgb magma(double t);

// Dark brown to grey-brown, for height maps, t in 0..1 (clamped); dark enough for bright overlays.
Rgb stone(double t);

}  // namespace intaglio::report
