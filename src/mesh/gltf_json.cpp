#include "mesh/gltf_json.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace intaglio::surface {

JsonValue JsonValue::operator[](const char* key) const {
  const JsonValue absent(nullptr, path_.empty() ? key : path_ + "." + key, *file_);
  if (!json_) return absent;
  if (!json_->is_object()) {
    fail("is not an object");
    return absent;
  }
  const auto found = json_->find(key);
  return found == json_->end() ? absent : JsonValue(&*found, absent.path_, *file_);
}

JsonValue JsonValue::operator[](std::size_t index) const {
  const std::string path = path_ + "[" + std::to_string(index) + "]";
  const std::size_t count = size();
  if (index < count) return {&(*json_)[index], path, *file_};
  const JsonValue absent(nullptr, path, *file_);
  absent.fail("is referenced but does not exist", fmt::format("{} has {}", path_, count));
  return absent;
}

std::size_t JsonValue::size() const {
  if (!json_) return 0;
  if (json_->is_array()) return json_->size();
  fail("is not an array");
  return 0;
}

std::size_t JsonValue::integer(std::size_t fallback, std::size_t limit) const {
  if (!json_) return fallback;
  if (json_->is_number_unsigned()) {
    if (const auto value = json_->get<std::uint64_t>(); value <= limit) return std::size_t(value);
  }
  fail(std::string("is ") + (json_->is_number() ? json_->dump() : json_->type_name()),
       fmt::format("expected an integer from 0 to {}", limit));
  return fallback;
}

std::size_t JsonValue::required_integer(std::size_t limit) const {
  if (!json_) fail("is missing");
  return integer(0, limit);
}

double JsonValue::number(double fallback) const {
  if (!json_) return fallback;
  if (json_->is_number()) return json_->get<double>();
  fail("is not a number");
  return fallback;
}

bool JsonValue::boolean(bool fallback) const {
  if (!json_) return fallback;
  if (json_->is_boolean()) return json_->get<bool>();
  fail("is not a boolean");
  return fallback;
}

std::string JsonValue::string() const {
  if (!json_) return {};
  if (json_->is_string()) return json_->get<std::string>();
  fail("is not a string");
  return {};
}

void JsonValue::fail(std::string what, std::string fix) const {
  if (file_->error) return;
  file_->error = Error{file_->name, path_.empty() ? std::move(what) : path_ + ": " + what, std::move(fix)};
}

std::string printable(std::string_view text) {
  std::string line(text.substr(0, 60));
  for (char& c : line) {
    if (std::uint8_t(c) < 0x20 || std::uint8_t(c) >= 0x7f) c = '?';
  }
  return line.size() < text.size() ? line + "..." : line;
}

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
    text += char(16 * hex_digit(uri[k + 1]) + hex_digit(uri[k + 2]));
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
    bits = bits << 6 | std::uint32_t(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(std::uint8_t(bits >> count));
  }
  return bytes;
}

std::optional<std::string> relative_file(std::string_view uri) {
  const auto name = percent_decoded(uri);
  if (!name || name->empty()) return std::nullopt;
  const auto forbidden = [](char c) { return std::uint8_t(c) < 0x20 || c == 0x7f || c == '\\' || c == ':'; };
  if (std::any_of(name->begin(), name->end(), forbidden)) return std::nullopt;
  const std::filesystem::path path(*name);
  if (path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end()) return std::nullopt;
  return name;
}

}  // namespace intaglio::surface
