#include "report/contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report/html.h"
#include "report/svg_plot.h"

namespace intaglio::report {

namespace {

constexpr double impact_seconds = 0.010;

double series_seconds(std::size_t samples, int rate) {
  return rate > 0 ? double(samples) / rate : 0;
}

}  // namespace

double shown_duration(const session::Recording& recording) {
  if (std::isfinite(recording.duration) && recording.duration > 1e-6 && recording.duration < 1e6)
    return recording.duration;
  double longest = std::max(series_seconds(recording.audio.size(), recording.sample_rate),
                            series_seconds(recording.servo.size(), recording.servo_rate));
  for (const session::BallTrack& ball : recording.balls) {
    longest = std::max(longest, series_seconds(ball.position.size(), recording.physics_rate));
  }
  return longest > 0 ? longest : 1;
}

std::vector<Impact> find_impacts(const session::Recording& recording) {
  std::vector<Impact> impacts;
  std::map<BodyId, std::size_t> last;  // of each body, an index into impacts
  for (const ContactEvent& event : recording.events) {
    const bool of_ball = event.body != recording.pen && event.body != floor_body;
    if (!of_ball || event.phase == ContactPhase::end || !std::isfinite(event.time)) continue;
    const double impulse = event.impulse.norm();
    const auto open = last.find(event.body);
    if (open != last.end() && event.time - impacts[open->second].time <= impact_seconds) {
      if (std::isfinite(impulse)) impacts[open->second].impulse += impulse;
    } else if (event.phase == ContactPhase::begin) {
      last[event.body] = impacts.size();
      impacts.push_back({event.time, event.body, std::isfinite(impulse) ? impulse : 0});
    }
  }
  return impacts;
}

std::vector<Impact> strongest(std::vector<Impact> impacts, std::size_t count, double apart) {
  std::stable_sort(impacts.begin(), impacts.end(),
                   [](const Impact& a, const Impact& b) { return a.impulse > b.impulse; });
  std::vector<Impact> kept;
  for (const Impact& impact : impacts) {
    if (kept.size() == count || impact.impulse < 0.1 * impacts.front().impulse) break;
    const auto near = [&](const Impact& other) { return std::abs(other.time - impact.time) < apart; };
    if (std::none_of(kept.begin(), kept.end(), near)) kept.push_back(impact);
  }
  std::stable_sort(kept.begin(), kept.end(),
                   [](const Impact& a, const Impact& b) { return a.time < b.time; });
  return kept;
}

std::string body_name(const session::Recording& recording, BodyId body) {
  for (const scene::Voice& voice : recording.voices) {
    if (voice.body == body && !voice.name.empty()) return voice.name;
  }
  if (body == floor_body) return "floor";
  return body == recording.pen ? "pen" : fmt::format("ball {}", body);
}

std::vector<TimeSpan> pen_touches(const session::Recording& recording) {
  std::vector<TimeSpan> spans;
  if (recording.servo_rate <= 0) return spans;
  const double tick = 1.0 / recording.servo_rate;
  bool touching = false;
  for (std::size_t k = 0; k < recording.servo.size(); ++k) {
    const double time = double(k) * tick;
    if (recording.servo[k].touching) {
      if (!touching) spans.push_back({time, time});
      spans.back().end = time + tick;
    }
    touching = recording.servo[k].touching;
  }
  return merged(std::move(spans), shown_duration(recording));
}

std::vector<TimeSpan> merged(std::vector<TimeSpan> spans, double duration) {
  std::sort(spans.begin(), spans.end(),
            [](const TimeSpan& a, const TimeSpan& b) { return a.begin < b.begin; });
  std::vector<TimeSpan> out;
  for (TimeSpan span : spans) {
    span = {std::max(span.begin, 0.0), std::min(span.end, duration)};
    if (!(span.begin < span.end)) continue;
    if (!out.empty() && span.begin <= out.back().end) {
      out.back().end = std::max(out.back().end, span.end);
    } else {
      out.push_back(span);
    }
  }
  return out;
}

double total_duration(std::span<const TimeSpan> spans) {
  double sum = 0;
  for (const TimeSpan& span : spans) sum += span.end - span.begin;
  return sum;
}

namespace {

constexpr double map_width = 540, map_left = 70, map_top = 12, map_right = 14, map_bottom = 52;
constexpr std::size_t most_dots = 500;

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
template <class PositionAt>
void draw_path(SvgPlot& plot, const MapView& view, const surface::Placement& placement, std::size_t count,
               std::string_view body, PositionAt&& position_at) {
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
      const Vec3 local = placement.to_local(position_at(k));
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

double largest_impulse(const session::Recording& recording) {
  double largest = 0;
  for (const ContactEvent& event : recording.events) {
    const double size = event.impulse.norm();
    if (event.body != recording.pen && std::isfinite(size)) largest = std::max(largest, size);
  }
  return largest;
}

// Dots at the balls' strongest contacts, area proportional to impulse; the pen's show as its path.
void draw_contacts(SvgPlot& plot, const MapView& view, const session::Recording& recording) {
  const double largest = largest_impulse(recording);
  const double least = 0.02 * largest;  // rolling is many small contacts, whose dots would hide the path
  std::vector<const ContactEvent*> events;
  for (const ContactEvent& event : recording.events) {
    const double size = event.impulse.norm();
    if (event.body != recording.pen && std::isfinite(size) && size > least) events.push_back(&event);
  }
  std::stable_sort(events.begin(), events.end(), [](const ContactEvent* a, const ContactEvent* b) {
    return a->impulse.norm() > b->impulse.norm();
  });
  if (events.size() > most_dots) events.resize(most_dots);
  for (const ContactEvent* event : events) {
    const Vec3 local = recording.surface->placement().to_local(event->point);
    if (!view.contains(local)) continue;
    const double impulse = event->impulse.norm();
    plot.circle(view.x(local.x()), view.y(local.y()), 10 * std::sqrt(impulse / largest),
                fmt::format("hit {}", body_css_class(event->body, recording.pen)),
                fmt::format("{}, {} s: {} N s", body_name(recording, event->body),
                            format_number(event->time, 3), format_number(impulse)));
  }
}

std::string map_svg(const session::Recording& recording, const MapView& view, std::string_view title) {
  const surface::Placement& placement = recording.surface->placement();
  SvgPlot plot(
      map_width, view.height(), "plot map", title,
      "Height map seen from above, with the paths of balls and pen drawn over it, and a dot for each "
      "contact.");
  const Range &x = view.x.units(), &y = view.y.units();
  plot.image(x.low, y.high, x.size(), y.low - y.high, data_uri(height_image(*recording.surface, view)));
  for (const session::BallTrack& ball : recording.balls) {
    draw_path(plot, view, placement, ball.position.size(), body_css_class(ball.body, recording.pen),
              [&](std::size_t k) { return ball.position[k]; });
  }
  draw_contacts(plot, view, recording);
  draw_path(plot, view, placement, recording.servo.size(), "pen", [&](std::size_t k) {
    const haptics::ServoSample& sample = recording.servo[k];
    return sample.touching ? sample.tip : Vec3::Constant(std::nan("")).eval();
  });
  plot.y_axis(view.x, view.y, "along +v, m", 5);
  plot.x_axis(view.x, y.low, "", 5);
  plot.text(0.5 * (x.low + x.high), y.low + 44, "along +u, m", "label", TextAnchor::middle);
  return plot.finish();
}

// Bounds of the pen's touches with a margin; empty if there are none or they span most of the surface.
std::vector<Range> pen_close_up(const session::Recording& recording) {
  const surface::Placement& placement = recording.surface->placement();
  std::vector<double> us, vs;
  for (const haptics::ServoSample& sample : recording.servo) {
    const Vec3 local = placement.to_local(sample.tip);
    if (!sample.touching || !local.allFinite() || !placement.covers(local)) continue;
    us.push_back(local.x());
    vs.push_back(local.y());
  }
  if (us.empty()) return {};
  Range u = range_of(us), v = range_of(vs);
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

std::string key_html(const session::Recording& recording) {
  std::string html = "<ul class=\"key\">\n";
  const auto way = [&](std::string_view body, const std::string& name) {
    html += fmt::format("<li><span class=\"ramp {}\"></span>{}, from start to end</li>\n", body,
                        escape_html(name));
  };
  for (const session::BallTrack& ball : recording.balls)
    way(body_css_class(ball.body, recording.pen), body_name(recording, ball.body));
  if (!recording.servo.empty()) way("pen", body_name(recording, recording.pen) + ", touching");
  if (const double largest = largest_impulse(recording); largest > 0) {
    html += fmt::format(
        "<li><span class=\"dot\"></span>contact, area by impulse, at most {}&nbsp;N&nbsp;s</li>\n",
        format_number(largest));
  }
  html += fmt::format(
      "<li><span class=\"ramp stone\"></span>height of the surface, {} to 0&nbsp;mm</li>\n</ul>\n",
      format_number(-1e3 * recording.surface->max_depth()));
  const surface::Placement& placement = recording.surface->placement();
  return html + fmt::format(
                    "<p class=\"note\">From above, against the normal; +u to the right and +v up, as in the "
                    "image. In the world, +u is {} and "
                    "+v is {}.</p>\n",
                    direction_text(placement.t()), direction_text(placement.b()));
}

}  // namespace

std::string seen_html(const session::Recording& recording) {
  if (!recording.surface) return "<p>No surface was recorded.</p>\n";
  const surface::Placement& placement = recording.surface->placement();
  std::string html = "<div class=\"maps\">\n<figure>\n";
  html += map_svg(recording, map_view({0, placement.size_u()}, {0, placement.size_v()}),
                  "The whole surface from above");
  html += "<figcaption>The whole surface</figcaption></figure>\n";
  if (const std::vector<Range> close_up = pen_close_up(recording); !close_up.empty()) {
    html += "<figure>\n" +
            map_svg(recording, map_view(close_up[0], close_up[1]), "Where the pen touched, from above");
    html += "<figcaption>Where the pen touched</figcaption></figure>\n";
  }
  return html + "<div class=\"aside\">\n" + key_html(recording) + "</div>\n</div>\n";
}

}  // namespace intaglio::report
