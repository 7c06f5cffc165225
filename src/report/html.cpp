#include "report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace intaglio::report {

namespace {

constexpr std::string_view not_known = "–";

// Mean of the pixels of `image` that fall into pixel (x, y) of an image `scale` times smaller.
std::uint8_t box_mean(const Image8& image, int x, int y, int c, double scale) {
  const int x0 = int(x * scale), y0 = int(y * scale);
  const int x1 = std::clamp(int((x + 1) * scale), x0 + 1, image.width);
  const int y1 = std::clamp(int((y + 1) * scale), y0 + 1, image.height);
  int sum = 0;
  for (int j = y0; j < y1; ++j) {
    for (int i = x0; i < x1; ++i) sum += image.at(i, j, c);
  }
  return std::uint8_t(sum / ((x1 - x0) * (y1 - y0)));
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
    }
  }
  return out;
}

std::string format_number(double value, int decimals) {
  if (!std::isfinite(value)) return std::string(not_known);
  if (std::abs(value) >= 1e15) return fmt::format("{:.2e}", value);
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text[0] != '-') return text;
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return (is_zero ? "" : "−") + text.substr(1);
}

std::string format_number(double value) {
  if (!std::isfinite(value)) return std::string(not_known);
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 1e-3 || size >= 1e7) return fmt::format("{:.2e}", value);
  return format_number(value, std::max(0, 2 - int(std::floor(std::log10(size)))));
}

std::string format_bytes(std::size_t bytes) {
  return format_number(double(bytes) * 1e-6, 1) + " MB";
}

std::string format_hex(std::uint64_t value) {
  return fmt::format("{:016x}", value);
}

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t three = (std::uint32_t{bytes[i]} << 16) |
                                (left > 1 ? std::uint32_t{bytes[i + 1]} << 8 : 0u) |
                                (left > 2 ? std::uint32_t{bytes[i + 2]} : 0u);
    out += digits[three >> 18];
    out += digits[(three >> 12) & 63];
    out += left > 1 ? digits[(three >> 6) & 63] : '=';
    out += left > 2 ? digits[three & 63] : '=';
  }
  return out;
}

std::string data_uri(std::string_view media_type, std::span<const std::uint8_t> bytes) {
  return fmt::format("data:{};base64,{}", media_type, base64(bytes));
}

std::string data_uri(const Image8& image) {
  return data_uri("image/png", encode_png(image));
}

std::string url_encoded(std::string_view path) {
  std::string out;
  for (const char c : path) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                          std::string_view("-_.~/").find(c) != std::string_view::npos;
    out += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

Image8 downscaled(const Image8& image, int width) {
  if (image.width <= width) return image;
  const double scale = double(image.width) / width;
  Image8 out(width, std::max(1, int(image.height / scale)), image.channels);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (int c = 0; c < out.channels; ++c) out.at(x, y, c) = box_mean(image, x, y, c, scale);
    }
  }
  return out;
}

std::string body_css_class(BodyId body, BodyId pen) {
  if (body == floor_body) return "floor";
  if (body == pen) return "pen";
  return fmt::format("ball-{}", (body - 1) % 4 + 1);
}

std::string page_head(std::string_view title, std::string_view css) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\">\n<title>{}</title>\n<style>\n{}\n</style>\n</head>\n<body>\n<main>\n",
      escape_html(title), css);
}

std::string table_row(std::string_view heading, std::string_view cell) {
  return fmt::format("<tr><th scope=\"row\">{}</th>{}</tr>\n", heading, cell);
}

const std::string_view report_css = R"css(
:root {
  color-scheme: light dark;
  --paper: #fdfcfa; --ink: #23201d; --soft: #6b645d; --rule: #e3ded7; --grid: #8884; --panel: #fff;
  --floor: #8f6b4f; --pen: #1769c2; --ball-1: #d9441c; --ball-2: #b0279c; --ball-3: #b98300; --ball-4: #2f8f5b;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #171513; --ink: #ece7e1; --soft: #a39b92; --rule: #37322d; --grid: #9993; --panel: #1d1a18;
    --floor: #c79f7f; --pen: #61a8f2; --ball-1: #ff7a4f; --ball-2: #e27ad2; --ball-3: #e5b53d; --ball-4: #6ccb97;
  }
}
.floor { --c: var(--floor); } .pen { --c: var(--pen); }
.ball-1 { --c: var(--ball-1); } .ball-2 { --c: var(--ball-2); } .ball-3 { --c: var(--ball-3); } .ball-4 { --c: var(--ball-4); }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.55 system-ui, "Segoe UI", "Liberation Sans", sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 48px 40px 80px; }
h1 { font-size: 34px; line-height: 1.2; margin: 0 0 8px; font-weight: 650; letter-spacing: -.01em; }
h2 { font-size: 21px; margin: 0 0 2px; font-weight: 650; }
p { margin: 0 0 12px; max-width: 112ch; }
.lead { font-size: 18px; color: var(--soft); margin-bottom: 28px; }
.note, figcaption, caption { color: var(--soft); font-size: 14px; }
section { margin-top: 52px; }
#tracks section { margin-top: 34px; }
section > p:first-of-type { color: var(--soft); margin-bottom: 14px; }
video { display: block; width: 100%; max-width: 900px; margin: 0 auto; border-radius: 6px; background: #000; }
.strip { display: grid; grid-template-columns: repeat(auto-fit, minmax(170px, 1fr)); gap: 14px; list-style: none; margin: 28px 0 0; padding: 0; }
.strip img { display: block; width: 100%; border-radius: 4px; }
figure { margin: 0; }
figcaption { margin-top: 4px; }
.maps { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 420px), 1fr)); gap: 20px 28px; }
.maps figcaption { margin-left: 13%; }
.aside { align-self: center; }
figure + figure + .aside { grid-column: 1 / -1; }
.key { list-style: none; display: flex; flex-wrap: wrap; gap: 6px 28px; margin: 0 0 10px; padding: 0; font-size: 14px; }
.key li { display: flex; align-items: center; gap: 9px; }
.ramp { width: 56px; height: 8px; border-radius: 4px; background: linear-gradient(90deg, var(--early, var(--c)), var(--last, var(--c))); }
.ramp:not(.stone), .way { --early: color-mix(in oklab, var(--c) 66%, #000); --last: color-mix(in oklab, var(--c) 62%, #fff); }
.map, .key {
  --pen: #3b9cff; --ball-1: #ff6a3a; --ball-2: #f06ade; --ball-3: #ffc533; --ball-4: #4fd68f;
}
.ramp.stone { background: linear-gradient(90deg, rgb(46 38 33), rgb(148 137 125)); }
.dot { display: inline-block; width: 12px; height: 12px; border-radius: 50%; background: var(--c, var(--soft)); }
th .dot { width: 10px; height: 10px; margin-right: 8px; }
.plot { display: block; width: 100%; height: auto; overflow: visible; font-size: 13px; }
.plot text { fill: var(--soft); font-variant-numeric: tabular-nums; }
.plot .label { fill: var(--ink); }
.grid { stroke: var(--grid); stroke-width: .7; }
.frame { fill: none; stroke: var(--grid); }
.axis { stroke: var(--soft); }
.curve { fill: none; stroke: var(--c); stroke-width: 1.5; stroke-linejoin: round; }
.curve.thin { stroke-width: 1; }
.area, .touch { fill: var(--pen); opacity: .1; }
.wave { fill: var(--soft); stroke: var(--soft); stroke-width: .5; }
.limit { stroke: var(--ink); stroke-width: 1; stroke-dasharray: 5 4; }
.impact { stroke: var(--c); stroke-width: 1; opacity: .38; }
.mark { fill: var(--c); }
.mode { stroke: var(--c); stroke-width: 1; opacity: .85; }
.way { fill: none; stroke: var(--c); stroke-width: 2.4; stroke-linejoin: round; stroke-linecap: round; }
@supports (color: color-mix(in oklab, red, blue)) { .way { stroke: color-mix(in oklab, var(--last) var(--late), var(--early)); } }
.hit { fill: var(--c); fill-opacity: .5; stroke: #fff; stroke-width: .6; stroke-opacity: .6; }
.cursor { stroke: var(--ink); stroke-width: 1; pointer-events: none; }
.agreement { margin: 0; display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 330px), 1fr)); gap: 18px; }
.agreement > div { background: var(--panel); border: 1px solid var(--rule); border-radius: 8px; padding: 18px 20px; }
.agreement dt { font-weight: 600; }
.agreement dd { margin: 0; color: var(--soft); font-size: 15px; }
.agreement b { display: block; color: var(--ink); font-size: 32px; font-weight: 600; line-height: 1.35; font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; margin-bottom: 28px; }
.wide:last-child table { width: auto; min-width: min(100%, 560px); }
table { border-collapse: collapse; width: 100%; font-size: 15px; font-variant-numeric: tabular-nums; }
caption { text-align: left; padding-bottom: 8px; }
th, td { text-align: left; padding: 7px 28px 7px 0; border-bottom: 1px solid var(--rule); font-weight: 400; vertical-align: baseline; }
thead th { color: var(--soft); font-size: 14px; }
tbody th { font-weight: 600; white-space: nowrap; }
th, td { white-space: nowrap; }
thead th.figure, .figure { text-align: right; }
th:last-child, td:last-child { padding-right: 0; }
code { font: 14px ui-monospace, "Liberation Mono", monospace; }
@media print {
  :root { color-scheme: light; --paper: #fff; }
  body { font-size: 11pt; -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  main { max-width: none; padding: 0; }
  video { display: none; }
  figure, .plot, .agreement > div, tr { break-inside: avoid; }
  h2, h2 + p { break-after: avoid; }
}
)css";

const std::string_view report_script = R"js(
const tracks = document.getElementById('tracks'), video = document.querySelector('video');
const {left, right, width, duration} = Object.fromEntries(Object.entries(tracks.dataset).map(([k, v]) => [k, Number(v)]));
const cursors = [...tracks.querySelectorAll('svg.track')].map(svg => {
  const line = document.createElementNS('http://www.w3.org/2000/svg', 'line');
  for (const [k, v] of Object.entries({class: 'cursor', y1: 0, y2: svg.viewBox.baseVal.height - 30, x1: -9, x2: -9})) line.setAttribute(k, v);
  return svg.appendChild(line);
});
const show = time => {
  const x = time >= 0 && time <= duration ? left + (right - left) * time / duration : -9;
  for (const line of cursors) { line.setAttribute('x1', x); line.setAttribute('x2', x); line.style.opacity = x < 0 ? 0 : 1; }
};
const time_at = event => {
  const box = cursors[0].ownerSVGElement.getBoundingClientRect();
  return ((event.clientX - box.left) / box.width * width - left) / (right - left) * duration;
};
if (cursors.length) {
  show(-1);
  tracks.addEventListener('pointermove', event => show(time_at(event)));
  tracks.addEventListener('pointerleave', () => show(-1));
  tracks.addEventListener('click', event => { if (video) video.currentTime = Math.max(0, Math.min(duration, time_at(event))); });
  const follow = () => { if (!video.paused) { show(video.currentTime); requestAnimationFrame(follow); } };
  if (video) { video.addEventListener('play', follow); video.addEventListener('seeked', () => show(video.currentTime)); }
}
)js";

}  // namespace intaglio::report
