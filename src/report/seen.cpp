#include "report/seen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "report/html.h"
#include "report/svg_plot.h"

namespace intaglio::report {

namespace {

constexpr double map_width = 540, map_left = 70, map_top = 12, map_right = 14, map_bottom = 52;

// A rectangle of the surface, local metres, on the drawing.
struct MapView {
  Axis x, y;

  double height() const { return y.units().low + map_bottom; }
  bool contains(const Vec3& local) const {
    const Range &u = x.values(), &v = y.values();
    return local.x() >= u.low && local.x() <= u.high && local.y() >= v.low && local.y() <= v.high;
  }
};

MapView map_view(const Range& u, const Range& v) {
  const double width = map_width - map_left - map_right;
  const double height = std::clamp(width * v.size() / u.size(), 60.0, 1.5 * width);
  return {Axis(u, {map_left, map_left + width}), Axis(v, {map_top + height, map_top})};
}

Image8 height_image(const surface::Surface& surface, const MapView& view) {
  const Range &u = view.x.values(), &v = view.y.values();
  const double drawn_width = view.x.units().size(), drawn_height = -view.y.units().size();
  Image8 image(int(drawn_width * 1.25), int(drawn_height * 1.25), 3);
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const Vec3 local(u.low + (i + 0.5) / image.width * u.size(),
                       v.high - (j + 0.5) / image.height * v.size(), 0);
      const double depth = surface.depth(surface.placement().uv(local));
      const Rgb colour = stone(surface.max_depth() > 0 ? 1 - depth / surface.max_depth() : 1);
      for (int c = 0; c < 3; ++c) image.at(i, j, c) = colour[std::size_t(c)];
    }
  }
  return image;
}

// Draws a body's path as polylines of increasing brightness; broken outside the view.
void draw_path(SvgPlot& plot, const MapView& view, const surface::Placement& placement,
               const std::vector<Vec3>& positions, std::string_view body) {
  const std::size_t count = positions.size();
  constexpr std::size_t tints = 32;
  for (std::size_t tint = 0; tint < tints; ++tint) {
    std::vector<double> xs, ys;
    const auto flush = [&] {
      const std::string style = fmt::format("--late:{}%", 100 * tint / (tints - 1));
      if (xs.size() > 1) plot.polyline(xs, ys, fmt::format("way {}", body), style);
      xs.clear();
      ys.clear();
    };
    const std::size_t begin = count * tint / tints, end = std::min(count * (tint + 1) / tints + 1, count);
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 local = placement.to_local(positions[k]);
      if (!local.allFinite() || !view.contains(local)) {
        flush();
        continue;
      }
      const double x = view.x(local.x()), y = view.y(local.y());
      // Skip points closer than half a unit, but keep a tint's last: it connects to the next tint.
      if (!xs.empty() && k + 1 < end && std::hypot(x - xs.back(), y - ys.back()) < 0.5) continue;
      xs.push_back(x);
      ys.push_back(y);
    }
    flush();
  }
}

// Dots at the balls' strongest contacts, area proportional to impulse; the pen's show as its path.
void draw_contacts(SvgPlot& plot, const MapView& view, const Digest& digest) {
  const session::Run& run = digest.run();
  for (const Hit& hit : digest.contacts().hits()) {
    const Vec3 local = run.surface->placement().to_local(hit.point);
    if (!view.contains(local)) continue;
    plot.circle(view.x(local.x()), view.y(local.y()),
                10 * std::sqrt(hit.impulse / digest.contacts().largest_impulse()),
                fmt::format("hit {}", body_css_class(hit.body, run.pen)),
                fmt::format("{}, {} s: {} N s", body_name(run, hit.body), format_number(hit.time, 3),
                            format_number(hit.impulse)));
  }
}

std::string map_svg(const Digest& digest, const MapView& view, std::string_view title) {
  const session::Run& run = digest.run();
  const surface::Placement& placement = run.surface->placement();
  SvgPlot plot(
      map_width, view.height(), "plot map", title,
      "Height map seen from above, with the paths of balls and pen drawn over it, and a dot for each "
      "contact.");
  const Range &x = view.x.units(), &y = view.y.units();
  plot.image(x.low, y.high, x.size(), y.low - y.high, data_uri(height_image(*run.surface, view)));
  for (const BallDigest& ball : digest.balls())
    draw_path(plot, view, placement, ball.path.samples(), body_css_class(ball.body, run.pen));
  draw_contacts(plot, view, digest);
  draw_path(plot, view, placement, digest.pen().path.samples(), "pen");
  plot.y_axis(view.x, view.y, "along +v, m", 5);
  plot.x_axis(view.x, y.low, "", 5);
  plot.text(0.5 * (x.low + x.high), y.low + 44, "along +u, m", "label", TextAnchor::middle);
  return plot.finish();
}

// Bounds of the pen's touches with a margin; empty if there are none or they span most of the surface.
std::vector<Range> pen_close_up(const Digest& digest) {
  const surface::Placement& placement = digest.run().surface->placement();
  const PenDigest& pen = digest.pen();
  if (!pen.has_touched) return {};
  const Range u = pen.touched_u.range(), v = pen.touched_v.range();
  const double side = std::max({1.3 * u.size(), 1.3 * v.size(), 0.02 * placement.size_u()});
  if (side > 0.6 * placement.size_u() || side > placement.size_v()) return {};
  const auto centred = [side](const Range& range, double size) {
    const double low = std::clamp(0.5 * (range.low + range.high - side), 0.0, size - side);
    return Range{low, low + side};
  };
  return {centred(u, placement.size_u()), centred(v, placement.size_v())};
}

std::string direction_text(const Vec3& v) {
  return fmt::format("({}, {}, {})", format_number(v.x(), 2), format_number(v.y(), 2),
                     format_number(v.z(), 2));
}

std::string key_html(const Digest& digest) {
  const session::Run& run = digest.run();
  std::string html = "<ul class=\"key\">\n";
  const auto way = [&](std::string_view body, const std::string& name) {
    html += fmt::format("<li><span class=\"ramp {}\"></span>{}, from start to end</li>\n", body,
                        escape_html(name));
  };
  for (const session::Ball& ball : run.balls)
    way(body_css_class(ball.body, run.pen), body_name(run, ball.body));
  if (digest.pen().ticks > 0) way("pen", body_name(run, run.pen) + ", touching");
  if (const double largest = digest.contacts().largest_impulse(); largest > 0) {
    html += fmt::format(
        "<li><span class=\"dot\"></span>contact, area by impulse, at most {}&nbsp;N&nbsp;s</li>\n",
        format_number(largest));
  }
  html += fmt::format(
      "<li><span class=\"ramp stone\"></span>height of the surface, {} to 0&nbsp;mm</li>\n</ul>\n",
      format_number(-1e3 * run.surface->max_depth()));
  const surface::Placement& placement = run.surface->placement();
  return html + fmt::format(
                    "<p class=\"note\">From above, against the normal; +u to the right and +v up, as in the "
                    "image. In the world, +u is {} and "
                    "+v is {}.</p>\n",
                    direction_text(placement.t()), direction_text(placement.b()));
}

}  // namespace

std::string seen_html(const Digest& digest) {
  if (!digest.run().surface) return "<p>No surface was recorded.</p>\n";
  const surface::Placement& placement = digest.run().surface->placement();
  std::string html = "<div class=\"maps\">\n<figure>\n";
  html += map_svg(digest, map_view({0, placement.size_u()}, {0, placement.size_v()}),
                  "The whole surface from above");
  html += "<figcaption>The whole surface</figcaption></figure>\n";
  if (const std::vector<Range> close_up = pen_close_up(digest); !close_up.empty()) {
    html += "<figure>\n" +
            map_svg(digest, map_view(close_up[0], close_up[1]), "Where the pen touched, from above");
    html += "<figcaption>Where the pen touched</figcaption></figure>\n";
  }
  return html + "<div class=\"aside\">\n" + key_html(digest) + "</div>\n</div>\n";
}

}  // namespace intaglio::report
