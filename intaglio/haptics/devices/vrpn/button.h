// Payloads of button messages. Decoders give nothing for a wrong size or a button out of range.
#pragma once

#include <optional>

#include "intaglio/haptics/devices/vrpn/wire.h"

namespace intaglio::haptics::vrpn {

inline constexpr std::int32_t button_limit = 256;

struct ButtonChange {
  std::int32_t button = 0;
  std::int32_t state = 0;  // 0 released, otherwise pressed
};

std::optional<ButtonChange> decode_button_change(View payload);
// The state of each button.
std::optional<std::vector<std::int32_t>> decode_button_states(View payload);

void encode(Bytes& out, const ButtonChange& change);
void encode(Bytes& out, const std::vector<std::int32_t>& states);

}  // namespace intaglio::haptics::vrpn
