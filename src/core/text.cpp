#include "core/text.h"

#include <cstdio>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <ostream>
#include <vector>

#include "intaglio/version.h"

namespace intaglio {

std::string Error::message() const {
  std::string line = where.empty() ? what : where + ": " + what;
  if (!fix.empty()) line += "; " + fix;
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

std::ostream& operator<<(std::ostream& out, const Error& error) {
  return out << error.message();
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return text;
}

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < 0x20 || c > 0x7e; }, '?');
  return text;
}

void print_error(std::string_view text) {
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
}

int edit_distance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = int(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

std::string json_quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (std::uint8_t(c) < 0x20) {
      out += fmt::format("\\u{:04x}", unsigned(std::uint8_t(c)));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

const char* version() {
  static const std::string text =
      fmt::format("{}.{}.{}", INTAGLIO_VERSION_MAJOR, INTAGLIO_VERSION_MINOR, INTAGLIO_VERSION_PATCH);
  return text.c_str();
}

}  // namespace intaglio
