#include "intaglio/surface/mesh/uri.h"

#include <algorithm>
#include <filesystem>

namespace intaglio::surface {

namespace {

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

std::optional<std::string> percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    if (uri[k] != '%') {
      text += uri[k];
      continue;
    }
    if (k + 2 >= uri.size() || hex_digit(uri[k + 1]) < 0 || hex_digit(uri[k + 2]) < 0) return std::nullopt;
    text += static_cast<char>(16 * hex_digit(uri[k + 1]) + hex_digit(uri[k + 2]));
    k += 2;
  }
  return text;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> data_uri(std::string_view uri) {
  constexpr std::string_view mark = ";base64,";
  const std::size_t at = uri.substr(0, 200).find(mark);
  if (!uri.starts_with("data:") || at == std::string_view::npos) return std::nullopt;
  std::string_view text = uri.substr(at + mark.size());
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int digit = base64_digit(c);
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  return bytes;
}

std::optional<std::string> side_file(std::string_view uri) {
  const auto name = percent_decoded(uri);
  if (!name || name->empty()) return std::nullopt;
  const auto forbidden = [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\' || c == ':';
  };
  if (std::any_of(name->begin(), name->end(), forbidden)) return std::nullopt;
  const std::filesystem::path path(*name);
  if (path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end()) return std::nullopt;
  return name;
}

}  // namespace intaglio::surface
