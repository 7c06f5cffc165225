// Payloads of the system messages that follow the cookie: names of senders and types, where a side listens
// for UDP, what it logs. Decoders give nothing for a payload that cannot be believed.
#pragma once

#include <optional>

#include "intaglio/haptics/devices/vrpn/message.h"

namespace intaglio::haptics::vrpn {

// Sender and type descriptions: int32 strlen + 1, the name, NUL. 1 to name_limit - 1 printable characters.
std::optional<std::string_view> decode_name(View payload);
void encode_name(Bytes& out, std::string_view name);

// UDP description (its port is in the header's sender field): IPv4 text, NUL.
std::optional<std::string> decode_udp_host(View payload);
void encode_udp_host(Bytes& out, std::string_view host);

// Whether a log description has the lengths it says. We never open a log for a peer.
bool sound_log_description(View payload);

// "<ip> <tcp-port>\0": by UDP request a client asks the server to dial it.
struct DialRequest {
  std::string host;  // letters, digits and '.'
  int port = 0;      // 1024..65535
};
std::optional<DialRequest> decode_dial_request(View datagram);
void encode_dial_request(Bytes& out, const DialRequest& request);

inline bool sound_port(std::int64_t port) {
  return port >= 1024 && port <= 65535;
}

}  // namespace intaglio::haptics::vrpn
