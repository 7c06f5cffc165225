#include "intaglio/session/letter.h"

#include <array>
#include <cstdint>

namespace intaglio::session {

namespace {

constexpr int columns = 5, rows = 7;

struct Glyph {
  char letter;
  std::array<std::uint8_t, rows> row;  // from the head down; the highest of five bits is the left one
};

constexpr Glyph glyphs[] = {
    {'A', {0b01110, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001}},
    {'B', {0b11110, 0b10001, 0b10001, 0b11110, 0b10001, 0b10001, 0b11110}},
    {'C', {0b01111, 0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b01111}},
    {'D', {0b11110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b11110}},
    {'E', {0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b11111}},
    {'F', {0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b10000}},
    {'G', {0b01111, 0b10000, 0b10000, 0b10111, 0b10001, 0b10001, 0b01111}},
    {'H', {0b10001, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001}},
    {'I', {0b11111, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b11111}},
    {'J', {0b00111, 0b00010, 0b00010, 0b00010, 0b00010, 0b10010, 0b01100}},
    {'K', {0b10001, 0b10011, 0b10110, 0b11100, 0b10110, 0b10011, 0b10001}},
    {'L', {0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b11111}},
    {'M', {0b10001, 0b11011, 0b11111, 0b10101, 0b10001, 0b10001, 0b10001}},
    {'N', {0b10001, 0b11001, 0b11101, 0b10111, 0b10011, 0b10001, 0b10001}},
    {'O', {0b01110, 0b11011, 0b10001, 0b10001, 0b10001, 0b11011, 0b01110}},
    {'P', {0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000, 0b10000}},
    {'Q', {0b01110, 0b11011, 0b10001, 0b10001, 0b10111, 0b11011, 0b01111}},
    {'R', {0b11110, 0b10001, 0b10001, 0b11110, 0b10110, 0b10011, 0b10001}},
    {'S', {0b01111, 0b10000, 0b10000, 0b01110, 0b00001, 0b00001, 0b11110}},
    {'T', {0b11111, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100}},
    {'U', {0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110}},
    {'V', {0b10001, 0b10001, 0b11011, 0b01010, 0b01110, 0b00100, 0b00100}},
    {'W', {0b10001, 0b10001, 0b10001, 0b10101, 0b11111, 0b11011, 0b10001}},
    {'X', {0b10001, 0b11011, 0b01110, 0b00100, 0b01110, 0b11011, 0b10001}},
    {'Y', {0b10001, 0b11011, 0b01110, 0b00100, 0b00100, 0b00100, 0b00100}},
    {'Z', {0b11111, 0b00011, 0b00110, 0b00100, 0b01100, 0b11000, 0b11111}},
    {'0', {0b01110, 0b11011, 0b10001, 0b10001, 0b10001, 0b11011, 0b01110}},
    {'1', {0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110}},
    {'2', {0b01110, 0b10001, 0b00011, 0b00110, 0b01100, 0b11000, 0b11111}},
    {'3', {0b11110, 0b00001, 0b00001, 0b01110, 0b00001, 0b00001, 0b11110}},
    {'4', {0b00110, 0b01110, 0b11010, 0b10010, 0b11111, 0b00010, 0b00010}},
    {'5', {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110}},
    {'6', {0b01110, 0b10000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110}},
    {'7', {0b11111, 0b00001, 0b00011, 0b00110, 0b00100, 0b01100, 0b01000}},
    {'8', {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110}},
    {'9', {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00001, 0b01110}},
};

using Raster = std::array<std::array<bool, columns>, rows>;

Raster raster_of(const Glyph& glyph) {
  Raster raster{};
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) raster[y][x] = ((glyph.row[y] >> (columns - 1 - x)) & 1) != 0;
  return raster;
}

// The largest rectangle that begins at (x, y) and goes on downwards as long as all of its row does.
struct Bar {
  std::size_t x0, y0, x1, y1;  // past the end
};
Bar take_bar(Raster& raster, std::size_t x, std::size_t y, bool tall_first) {
  Bar bar{x, y, x + 1, y + 1};
  const auto filled = [&](std::size_t x0, std::size_t x1, std::size_t at) {
    for (std::size_t k = x0; k < x1; ++k)
      if (!raster[at][k]) return false;
    return true;
  };
  if (!tall_first)
    while (bar.x1 < columns && raster[y][bar.x1]) ++bar.x1;
  while (bar.y1 < rows && filled(bar.x0, bar.x1, bar.y1)) ++bar.y1;
  for (std::size_t j = bar.y0; j < bar.y1; ++j)
    for (std::size_t i = bar.x0; i < bar.x1; ++i) raster[j][i] = false;
  return bar;
}

}  // namespace

std::optional<contact::Shape> letter_shape(const std::string& text, const Vec3& size) {
  if (text.size() != 1) return std::nullopt;
  for (const Glyph& glyph : glyphs) {
    if (glyph.letter != text[0]) continue;
    Raster raster = raster_of(glyph);
    std::vector<contact::CompoundChild> children;
    const Vec3 cell(size.x() / columns, size.y(), size.z() / rows);
    for (std::size_t y = 0; y < rows; ++y) {
      for (std::size_t x = 0; x < columns; ++x) {
        if (!raster[y][x]) continue;
        const bool tall = x + 1 == columns || !raster[y][x + 1];
        const Bar bar = take_bar(raster, x, y, tall);
        const Vec3 low(static_cast<double>(bar.x0), -0.5, static_cast<double>(bar.y0));
        const Vec3 high(static_cast<double>(bar.x1), 0.5, static_cast<double>(bar.y1));
        const Vec3 middle = 0.5 * (low + high) - Vec3(0.5 * columns, 0, 0.5 * rows);
        children.push_back({contact::Box{0.5 * (high - low).cwiseProduct(cell)},
                            {middle.cwiseProduct(cell), Quat::Identity()}});
      }
    }
    return contact::make_compound(std::move(children));
  }
  return std::nullopt;
}

}  // namespace intaglio::session
