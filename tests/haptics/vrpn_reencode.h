// Decodes and encodes a payload: a valid one gives the same bytes. For tests and the fuzzer.
#pragma once

#include "haptics/vrpn/force.h"
#include "haptics/vrpn/message.h"
#include "haptics/vrpn/payloads.h"

namespace intaglio::haptics::vrpn {

template <class T>
std::optional<Bytes> encoded(const std::optional<T>& decoded) {
  if (!decoded) return std::nullopt;
  Bytes out;
  encode(out, *decoded);
  return out;
}

// Nothing when the decoder rejects the payload.
inline std::optional<Bytes> reencode(Type type, View payload) {
  switch (type) {
    case Type::ping:
    case Type::pong:
      return payload.empty() ? std::optional(Bytes()) : std::nullopt;
    case Type::text:
      return encoded(decode_text(payload));
    case Type::pos_quat:
      return encoded(decode_pos_quat(payload));
    case Type::velocity:
    case Type::acceleration:
      return encoded(decode_motion(payload));
    case Type::set_update_rate: {
      const auto rate = decode_update_rate(payload);
      if (!rate) return std::nullopt;
      Bytes out;
      put(out, *rate);
      return out;
    }
    case Type::button_change:
      return encoded(decode_button_change(payload));
    case Type::button_states:
      return encoded(decode_button_states(payload));
    case Type::force:
      return encoded(decode_force(payload));
    case Type::force_field:
      return encoded(decode_force_field(payload));
    case Type::plane:
      return encoded(decode_plane(payload));
    case Type::plane2:
      return encoded(decode_plane_effects(payload));
    case Type::scp:
      return encoded(decode_scp(payload));
    case Type::force_error:
      return encoded(decode_force_error(payload));
  }
  return std::nullopt;
}

// The same for system messages with an encoder.
inline std::optional<Bytes> reencode_system(std::int32_t type, View payload) {
  Bytes out;
  if (type == sender_description || type == type_description) {
    const auto name = decode_name(payload);
    if (!name) return std::nullopt;
    encode_name(out, *name);
  } else if (type == udp_description) {
    const auto host = decode_udp_host(payload);
    if (!host) return std::nullopt;
    encode_udp_host(out, *host);
  } else {
    return std::nullopt;
  }
  return out;
}

}  // namespace intaglio::haptics::vrpn
