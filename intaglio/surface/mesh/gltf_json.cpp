#include "intaglio/surface/mesh/gltf_json.h"

#include <nlohmann/json.hpp>

namespace intaglio::surface {

JsonValue JsonValue::operator[](const char* key) const {
  const JsonValue absent(nullptr, path_.empty() ? key : path_ + "." + key, file_, *error_);
  if (!json_) return absent;
  if (!json_->is_object()) {
    fail("is not an object");
    return absent;
  }
  const auto found = json_->find(key);
  return found == json_->end() ? absent : JsonValue(&*found, absent.path_, file_, *error_);
}

JsonValue JsonValue::operator[](std::size_t index) const {
  const std::string path = fmt::format("{}[{}]", path_, index);
  const std::size_t count = size();
  if (index < count) return {&(*json_)[index], path, file_, *error_};
  const JsonValue absent(nullptr, path, file_, *error_);
  absent.fail("is asked for but not there", fmt::format("{} has {}", path_, count));
  return absent;
}

std::size_t JsonValue::size() const {
  if (!json_) return 0;
  if (json_->is_array()) return json_->size();
  fail("is not an array");
  return 0;
}

std::vector<std::string> JsonValue::keys() const {
  std::vector<std::string> names;
  if (!json_ || !json_->is_object()) return names;
  for (const auto& item : json_->items()) names.push_back(item.key());
  return names;
}

std::size_t JsonValue::whole(std::size_t otherwise, std::size_t limit) const {
  if (!json_) return otherwise;
  if (json_->is_number_unsigned()) {
    if (const auto value = json_->get<std::uint64_t>(); value <= limit)
      return static_cast<std::size_t>(value);
  }
  fail(std::string("is ") + (json_->is_number() ? json_->dump() : json_->type_name()),
       fmt::format("a whole number from 0 to {} belongs there", limit));
  return otherwise;
}

std::size_t JsonValue::required_whole(std::size_t limit) const {
  if (!json_) fail("is missing");
  return whole(0, limit);
}

double JsonValue::number(double otherwise) const {
  if (!json_) return otherwise;
  if (json_->is_number()) return json_->get<double>();
  fail("is not a number");
  return otherwise;
}

bool JsonValue::truth(bool otherwise) const {
  if (!json_) return otherwise;
  if (json_->is_boolean()) return json_->get<bool>();
  fail("is neither true nor false");
  return otherwise;
}

std::string JsonValue::text() const {
  if (!json_) return {};
  if (json_->is_string()) return json_->get<std::string>();
  fail("is not a text");
  return {};
}

void JsonValue::fail(std::string what, std::string fix) const {
  if (*error_) return;
  *error_ = Error{file_, path_.empty() ? std::move(what) : path_ + ": " + what, std::move(fix)};
}

std::string printable(std::string_view text) {
  std::string line(text.substr(0, 60));
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
  }
  return line.size() < text.size() ? line + "..." : line;
}

}  // namespace intaglio::surface
