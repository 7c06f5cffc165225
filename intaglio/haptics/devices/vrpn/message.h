// One VRPN message: a header of 24 bytes, then the payload, padded to a multiple of 8.
//
// The length in the header counts header and payload but not the padding. A message that is taken points into
// the bytes it was taken from. Any thread. Source: the wire format as measured on running peers
// (docs/devices.md).
#pragma once

#include "intaglio/haptics/devices/vrpn/wire.h"

namespace intaglio::haptics::vrpn {

inline constexpr int default_port = 3883;
inline constexpr std::size_t header_size = 24;
inline constexpr std::size_t message_limit = 64000;  // bytes, header and payload
inline constexpr std::size_t datagram_limit = 1472;  // bytes of UDP payload

// System types, in the header's type field.
inline constexpr std::int32_t sender_description = -1;
inline constexpr std::int32_t type_description = -2;
inline constexpr std::int32_t udp_description = -3;
inline constexpr std::int32_t log_description = -4;
inline constexpr std::int32_t disconnect_message = -5;

// Wall-clock time, as the sender saw it.
struct Stamp {
  std::int32_t seconds = 0;
  std::int32_t microseconds = 0;

  static Stamp now();
};

struct Message {
  Stamp time;
  std::int32_t sender = 0;    // numbered by the sending side
  std::int32_t type = 0;      // numbered by the sending side; negative: system
  std::int32_t sequence = 0;  // receivers ignore it
  View payload;
};

enum class Frame {
  whole,    // a message was taken
  partial,  // more bytes are needed
  bad,      // the length cannot be believed
};

struct Taken {
  Frame frame = Frame::partial;
  std::size_t size = 0;  // bytes used up, with padding; of a bad frame the header alone
  Message message;
};

// The first message of `bytes`.
Taken take_message(View bytes);

// Appends the message with its header, padded with zeros. The payload must fit the limit.
void append_message(Bytes& out, const Message& message);

}  // namespace intaglio::haptics::vrpn
