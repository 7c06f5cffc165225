// Text that is safe to put into the report: escaped, and never "nan" or "inf".
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/event.h"
#include "core/image.h"

namespace intaglio::report {

// For HTML and SVG, content and attribute values alike. Control characters, which no page may hold, become
// spaces.
std::string escaped(std::string_view text);

// A value for people: fixed decimals, a true minus sign, "–" when it is not finite.
std::string number(double value, int decimals);
// Three significant digits and no exponent between 0.001 and ten million.
std::string number(double value);
std::string bytes_text(std::size_t bytes);  // "12.3 MB"
std::string hex_text(std::uint64_t value);  // 16 digits

// "data:<type>;base64,...": a file inside the page.
std::string data_uri(std::string_view media_type, std::span<const std::uint8_t> bytes);
std::string data_uri(const Image8& image);  // as PNG

// Box-filtered so that it is at most `width` pixels wide; never enlarged.
Image8 shrunk(const Image8& image, int width);

// The CSS class that gives a body its colour, the same in every plot: "floor", "pen", "ball-1" .. "ball-4".
std::string body_class(BodyId body, BodyId pen);

// The report's style sheet, light, dark and for print, and its script: a cursor through all tracks that goes
// with the video. The page says all it has to say without the script.

extern const std::string_view report_css;
extern const std::string_view report_script;

}  // namespace intaglio::report
