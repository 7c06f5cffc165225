#include "intaglio/haptics/devices/vrpn/button.h"

namespace intaglio::haptics::vrpn {

std::optional<ButtonChange> decode_button_change(View payload) {
  Reader reader(payload);
  const ButtonChange change{reader.i32(), reader.i32()};
  if (!reader.done() || change.button < 0 || change.button >= button_limit) return std::nullopt;
  return change;
}

std::optional<std::vector<std::int32_t>> decode_button_states(View payload) {
  Reader reader(payload);
  const std::int32_t count = reader.i32();
  if (!reader.ok() || count < 0 || count > button_limit) return std::nullopt;
  if (reader.left() != 4 * static_cast<std::size_t>(count)) return std::nullopt;
  std::vector<std::int32_t> states(static_cast<std::size_t>(count));
  for (std::int32_t& state : states) state = reader.i32();
  return states;
}

void encode(Bytes& out, const ButtonChange& change) {
  put(out, change.button);
  put(out, change.state);
}

void encode(Bytes& out, const std::vector<std::int32_t>& states) {
  put(out, static_cast<std::int32_t>(states.size()));
  for (const std::int32_t state : states) put(out, state);
}

}  // namespace intaglio::haptics::vrpn
