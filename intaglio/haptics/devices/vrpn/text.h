// Payload of a text message: what a device wants its user to read. Severity 0 normal, 1 warning, 2 error.
#pragma once

#include <optional>

#include "intaglio/haptics/devices/vrpn/wire.h"

namespace intaglio::haptics::vrpn {

inline constexpr std::size_t text_limit = 1024;  // bytes, with the NUL

struct Text {
  std::uint32_t severity = 0;
  std::uint32_t level = 0;
  std::string text;  // up to its first NUL; all but printable ASCII become spaces
};

// Nothing for a wrong size or an unknown severity.
std::optional<Text> decode_text(View payload);
// Cuts what is too long.
void encode(Bytes& out, const Text& text);

}  // namespace intaglio::haptics::vrpn
