#include "intaglio/session/report_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "intaglio/haptics/guard.h"
#include "intaglio/session/report_contacts.h"
#include "intaglio/session/report_text.h"

namespace intaglio::session {

namespace {

// Names what a colour is, right of a plot area: `row` counts from its top.
void name_curve(SvgPlot& plot, const Axis& y, int row, std::string_view name, std::string_view classes) {
  const double x = track_area.high + 14, at = y.units().high + 12 + 18 * row;
  plot.line(x, at - 4, x + 16, at - 4, fmt::format("curve {}", classes));
  plot.text(x + 22, at, name, "tick");
}

double step_of(int rate) {
  return rate > 0 ? 1.0 / rate : std::nan("");
}

struct PenSeries {
  std::vector<double> tip, surface, force;  // mm, mm, N
  Range heights;                            // what is worth showing: where it touches, and some room above
};

PenSeries pen_series(const Recording& recording) {
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
  plot.text(track_area.high + 14, y(limit) + 4, number(limit, 1) + " N, the guard", "tick");
}

struct BallSeries {
  std::string name, colour;
  std::vector<double> height, speed;  // m, m/s
};

BallSeries ball_series(const Recording& recording, const BallTrack& ball) {
  BallSeries series{body_name(recording, ball.body), body_class(ball.body, recording.pen), {}, {}};
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

// A ball that leaves the surface falls for ever: what is deep below is not worth the axis.
Range height_range(const Recording& recording, const std::vector<BallSeries>& balls) {
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

}  // namespace

Axis time_axis(const Recording& recording) {
  return Axis({0, shown_duration(recording)}, track_area);
}

void draw_impacts(SvgPlot& plot, const Recording& recording, double top, double bottom) {
  const Axis time = time_axis(recording);
  for (const Impact& impact : strongest(impacts_of(recording), 40, 0.03)) {
    if (impact.time < 0 || impact.time > time.values().high) continue;
    plot.line(time(impact.time), top, time(impact.time), bottom,
              fmt::format("impact {}", body_class(impact.body, recording.pen)));
  }
}

std::string felt_html(const Recording& recording) {
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
  name_curve(plot, height, 0, "pen’s tip", "pen");
  name_curve(plot, height, 1, "surface", "floor");
  draw_force(plot, time, force, {0, step, pen.force});
  plot.x_axis(time, force.units().low, "s", track_time_ticks);
  return plot.finish();
}

std::string moved_html(const Recording& recording) {
  std::vector<BallSeries> balls;
  for (const BallTrack& ball : recording.balls) balls.push_back(ball_series(recording, ball));
  if (balls.empty()) return "<p>No ball took part.</p>\n";
  const double step = step_of(recording.physics_rate);
  const Axis time = time_axis(recording);
  const Range heights = height_range(recording, balls);
  const bool in_mm = heights.size() < 0.1;
  const Axis height({heights.low * (in_mm ? 1e3 : 1), heights.high * (in_mm ? 1e3 : 1)}, {140, 10});
  const Axis speed(speed_range(balls), {244, 160});
  SvgPlot plot(track_width, speed.units().low + track_axis_height, "plot track", "Moved",
               "The height of each ball’s lowest point over the base plane, and its speed, over time.");
  plot.y_axis(time, height, in_mm ? "height, mm" : "height, m", 4);
  plot.y_axis(time, speed, "speed, m/s", 3);
  draw_impacts(plot, recording, height.units().high, speed.units().low);
  plot.line(track_area.low, height(0), track_area.high, height(0), "curve floor thin");
  name_curve(plot, height, 0, "base plane", "floor thin");
  int row = 1;
  for (BallSeries& ball : balls) {
    if (in_mm)
      std::transform(ball.height.begin(), ball.height.end(), ball.height.begin(),
                     [](double h) { return 1e3 * h; });
    plot.curve(time, height, {step, step, ball.height}, "curve " + ball.colour);
    plot.curve(time, speed, {step, step, ball.speed}, "curve " + ball.colour);
    if (row < 7) name_curve(plot, height, row++, ball.name, ball.colour);
  }
  plot.x_axis(time, speed.units().low, "s", track_time_ticks);
  return plot.finish();
}

}  // namespace intaglio::session
