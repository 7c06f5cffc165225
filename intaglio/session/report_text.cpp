#include "intaglio/session/report_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace intaglio::session {

namespace {

constexpr std::string_view unknown = "–";

// Mean of the pixels of `image` that fall into pixel (x, y) of an image that is `scale` times smaller.
std::uint8_t box_mean(const Image8& image, int x, int y, int c, double scale) {
  const int x0 = static_cast<int>(x * scale), y0 = static_cast<int>(y * scale);
  const int x1 = std::clamp(static_cast<int>((x + 1) * scale), x0 + 1, image.width);
  const int y1 = std::clamp(static_cast<int>((y + 1) * scale), y0 + 1, image.height);
  int sum = 0;
  for (int j = y0; j < y1; ++j) {
    for (int i = x0; i < x1; ++i) sum += image.at(i, j, c);
  }
  return static_cast<std::uint8_t>(sum / ((x1 - x0) * (y1 - y0)));
}

}  // namespace

std::string escaped(std::string_view text) {
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

std::string number(double value, int decimals) {
  if (!std::isfinite(value)) return std::string(unknown);
  if (std::abs(value) >= 1e15) return fmt::format("{:.2e}", value);
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text[0] != '-') return text;
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return (is_zero ? "" : "−") + text.substr(1);
}

std::string number(double value) {
  if (!std::isfinite(value)) return std::string(unknown);
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 1e-3 || size >= 1e7) return fmt::format("{:.2e}", value);
  return number(value, std::max(0, 2 - static_cast<int>(std::floor(std::log10(size)))));
}

std::string bytes_text(std::size_t bytes) {
  return number(static_cast<double>(bytes) * 1e-6, 1) + " MB";
}

std::string hex_text(std::uint64_t value) {
  return fmt::format("{:016x}", value);
}

std::string data_uri(std::string_view media_type, std::span<const std::uint8_t> bytes) {
  static constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out = fmt::format("data:{};base64,", media_type);
  out.reserve(out.size() + (bytes.size() + 2) / 3 * 4);
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

std::string data_uri(const Image8& image) {
  return data_uri("image/png", encode_png(image));
}

Image8 shrunk(const Image8& image, int width) {
  if (image.width <= width) return image;
  const double scale = static_cast<double>(image.width) / width;
  Image8 out(width, std::max(1, static_cast<int>(image.height / scale)), image.channels);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (int c = 0; c < out.channels; ++c) out.at(x, y, c) = box_mean(image, x, y, c, scale);
    }
  }
  return out;
}

std::string body_class(BodyId body, BodyId pen) {
  if (body == floor_body) return "floor";
  if (body == pen) return "pen";
  return fmt::format("ball-{}", (body - 1) % 4 + 1);
}

}  // namespace intaglio::session
