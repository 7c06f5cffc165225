// HTML and SVG text helpers: escaping, number formatting (never "nan" or "inf"), data URIs, pages.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "intaglio/event.h"
#include "intaglio/image.h"

namespace intaglio::report {

// For HTML and SVG, content and attribute values alike. Control characters are replaced by spaces.
std::string escape_html(std::string_view text);

// Fixed decimals, U+2212 as minus sign, "–" when not finite.
std::string format_number(double value, int decimals);
// Three significant digits and no exponent between 0.001 and ten million.
std::string format_number(double value);
std::string format_bytes(std::size_t bytes);  // "12.3 MB"
std::string format_hex(std::uint64_t value);  // 16 digits

// "data:<type>;base64,...": an embedded file.
std::string data_uri(std::string_view media_type, std::span<const std::uint8_t> bytes);
// Its letters: for a file in pieces, each but the last of a multiple of three bytes.
std::string base64(std::span<const std::uint8_t> bytes);
std::string data_uri(const Image8& image);  // as PNG

// Percent-encoded for a URL; slashes stay.
std::string url_encoded(std::string_view path);

// Box-filtered so that it is at most `width` pixels wide; never enlarged.
Image8 downscaled(const Image8& image, int width);

// The CSS class that gives a body its colour, the same in every plot: "floor", "pen", "ball-1" .. "ball-4".
std::string body_css_class(BodyId body, BodyId pen);

// The start of a page up to and including <main>, with this title and style sheet, and its end.
std::string page_head(std::string_view title, std::string_view css);
inline constexpr std::string_view page_end = "</main>\n</body>\n</html>\n";
// <tr> with a heading and one cell, given as its <td> element.
std::string table_row(std::string_view heading, std::string_view cell);

// The report's style sheet, light, dark and for print, and its script: a cursor across all tracks,
// synchronised with the video. The page is complete without the script.
extern const std::string_view report_css;
extern const std::string_view report_script;

}  // namespace intaglio::report
