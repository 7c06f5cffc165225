#include "intaglio/haptics/devices/vrpn/text.h"

#include <algorithm>

namespace intaglio::haptics::vrpn {

std::optional<Text> decode_text(View payload) {
  Reader reader(payload);
  Text text;
  text.severity = reader.u32();
  text.level = reader.u32();
  const std::string_view characters = text_of(reader.raw(text_limit));
  if (!reader.done() || text.severity > 2) return std::nullopt;
  text.text = characters.substr(0, characters.find('\0'));
  // A terminal obeys control characters, and JSON wants UTF-8.
  std::replace_if(
      text.text.begin(), text.text.end(), [](char c) { return c < ' ' || c > '~'; }, ' ');
  return text;
}

void encode(Bytes& out, const Text& text) {
  put(out, text.severity);
  put(out, text.level);
  const std::size_t end = out.size() + text_limit;
  put(out, std::string_view(text.text).substr(0, text_limit - 1));
  out.resize(end);
}

}  // namespace intaglio::haptics::vrpn
