// The VRPN wire format: numbers, messages and their framing, the cookie, names and ids, and the payloads of
// system messages. Source: measured on running peers (docs/devices.md). Payloads of devices: payloads.h,
// force.h.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/vec.h"

namespace intaglio::haptics::vrpn {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

// Reads numbers as VRPN sends them: big-endian, IEEE floats. Reading is bounded: everything beyond the end
// reads as zero and makes ok() false, so that a decoder checks once, at its end, before using any value.
class Reader {
 public:
  explicit Reader(ByteView bytes) : bytes_(bytes) {}

  std::uint32_t u32() { return big_endian<std::uint32_t>(); }
  std::int32_t i32() { return std::int32_t(u32()); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(big_endian<std::uint64_t>()); }
  Vec3 vec3() {
    const double x = f64(), y = f64(), z = f64();
    return {x, y, z};
  }
  // The next `size` bytes; empty when there are fewer.
  ByteView raw(std::size_t size) {
    if (size > bytes_.size()) ok_ = false;
    const ByteView taken = ok_ ? bytes_.first(size) : ByteView();
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }

  std::size_t left() const { return bytes_.size(); }
  bool ok() const { return ok_; }                     // nothing was read beyond the end
  bool at_end() const { return ok_ && left() == 0; }  // and nothing is left over

 private:
  template <std::unsigned_integral T>
  T big_endian() {
    T value = 0;
    for (const std::uint8_t byte : raw(sizeof(T))) value = static_cast<T>(value << 8 | byte);
    return value;
  }

  ByteView bytes_;
  bool ok_ = true;
};

template <std::unsigned_integral T>
void put(Bytes& out, T value) {
  for (int shift = 8 * (int(sizeof(T)) - 1); shift >= 0; shift -= 8)
    out.push_back(std::uint8_t(value >> shift));
}
inline void put(Bytes& out, std::int32_t value) {
  put(out, std::uint32_t(value));
}
inline void put(Bytes& out, float value) {
  put(out, std::bit_cast<std::uint32_t>(value));
}
inline void put(Bytes& out, double value) {
  put(out, std::bit_cast<std::uint64_t>(value));
}
inline void put(Bytes& out, const Vec3& v) {
  for (int k = 0; k < 3; ++k) put(out, v[k]);
}
inline void put(Bytes& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
}

// Printable ASCII, whatever the locale.
inline bool is_printable(char c) {
  return c >= ' ' && c <= '~';
}

inline std::string_view text_of(ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// A message is a header of 24 bytes and a payload, padded to a multiple of 8. The length in the header counts
// header and payload but not the padding.

inline constexpr int default_port = 3883;
inline constexpr std::size_t header_size = 24;
inline constexpr std::size_t message_limit = 64000;  // bytes, header and payload
inline constexpr std::size_t datagram_limit = 1472;  // bytes of UDP payload

// Size with padding.
inline std::size_t padded(std::size_t size) {
  return (size + 7) / 8 * 8;
}

// System types, in the header's type field.
inline constexpr std::int32_t sender_description = -1;
inline constexpr std::int32_t type_description = -2;
inline constexpr std::int32_t udp_description = -3;
inline constexpr std::int32_t log_description = -4;
inline constexpr std::int32_t disconnect_message = -5;

// Wall-clock time of the sender.
struct Stamp {
  std::int32_t seconds = 0;
  std::int32_t microseconds = 0;

  static Stamp now();
};

struct Message {
  Stamp time;
  std::int32_t sender = 0;    // id, chosen by the sending side
  std::int32_t type = 0;      // id, chosen by the sending side; negative: system
  std::int32_t sequence = 0;  // ignored by receivers
  ByteView payload;
};

enum class Frame {
  complete,  // a message
  partial,   // more bytes are needed
  bad,       // invalid length
};

struct ParsedMessage {
  Frame frame = Frame::partial;
  std::size_t size = 0;  // bytes consumed, with padding; only the header of a bad frame
  Message message;
};

// Parses the first message of `bytes`; its payload points into them.
// Fuzzed by fuzz/vrpn.cpp through Framer
ParsedMessage parse_message(ByteView bytes);

// Appends the message with its header, padded with zeros. Must not exceed message_limit.
void append_message(Bytes& out, const Message& message);

// Splits a byte stream into messages, however the network cuts it.
//
// A frame of invalid length counts as bad, and only its 24 bytes of header are skipped; parsing resumes right
// after them, so that a stream that is out of step soon produces enough bad frames for its peer to be
// dropped. Holds at most one message and the bytes of one read. One thread.
class Framer {
 public:
  // Appends bytes as they were read. Invalidates earlier messages.
  void feed(ByteView bytes);
  // The next complete message, valid until the next feed(); none when more bytes are needed.
  std::optional<Message> next();
  // The next `size` bytes unparsed (the cookie); empty when there are fewer.
  ByteView take(std::size_t size);

  int bad_frames() const { return bad_frames_; }
  // Bytes of an incomplete message.
  std::size_t waiting() const { return buffer_.size() - used_; }

 private:
  ByteView rest() const { return ByteView(buffer_).subspan(used_); }

  Bytes buffer_;
  std::size_t used_ = 0;
  int bad_frames_ = 0;
};

// The cookie, the 24 bytes with which each side opens a connection: "vrpn: ver. 07.38", two spaces, a digit
// for the log mode requested of the other side, NULs. Two sides are compatible when they agree up to the last
// '.'; a different minor version deserves a warning only.

inline constexpr std::size_t cookie_size = 24;

enum class CookieMatch { same, other_minor_version, not_vrpn };

struct Cookie {
  CookieMatch match = CookieMatch::not_vrpn;
  int log_mode = 0;     // 0..3; ignored: we never write log files for a peer
  std::string version;  // "07.38"; empty for not_vrpn
};

// Never requests logging.
std::array<std::uint8_t, cookie_size> our_cookie();
// `bytes` must hold cookie_size bytes.
Cookie read_cookie(ByteView bytes);

// Sender and type names: each side chooses its own ids and sends their names. A peer's ids are never trusted:
// at most id_limit of each, names within name_limit. An id that was never named is ignored and is not an
// error, as UDP data may overtake the TCP message that names its type.

// The types that we know; the values are our own ids.
enum class Type : std::int32_t {
  ping,
  pong,
  text,
  pos_quat,
  velocity,
  acceleration,
  set_update_rate,
  button_change,
  button_states,
  force,
  force_field,
  plane,
  plane2,
  scp,
  force_error,
};

inline constexpr std::array<std::string_view, 15> type_names = {
    "vrpn_Base ping_message",       "vrpn_Base pong_message",       "vrpn_Base text_message",
    "vrpn_Tracker Pos_Quat",        "vrpn_Tracker Velocity",        "vrpn_Tracker Acceleration",
    "vrpn_Tracker set_update_rate", "vrpn_Button Change",           "vrpn_Button States",
    "vrpn_ForceDevice Force",       "vrpn_ForceDevice Force_Field", "vrpn_ForceDevice Plane",
    "vrpn_ForceDevice Plane2",      "vrpn_ForceDevice SCP",         "vrpn_ForceDevice Force_Error",
};

inline constexpr std::size_t name_limit = 100;  // bytes, with the NUL
inline constexpr std::int32_t id_limit = 2000;

// The type of that name, if known.
std::optional<Type> find_type(std::string_view name);

// The names of a peer's ids.
class PeerNames {
 public:
  // Both return false for an id out of range.
  bool learn_sender(std::int32_t id, std::string_view name);
  bool learn_type(std::int32_t id, std::string_view name);

  // Empty for an id that was never named.
  std::string_view sender(std::int32_t id) const;
  std::optional<Type> type(std::int32_t id) const;
  // In the order of their ids.
  std::vector<std::string> senders() const;
  // Whether the peer has named this type.
  bool has_named(Type type) const;

 private:
  std::vector<std::string> senders_;
  std::vector<std::optional<Type>> types_;
};

// Payloads of the system messages that follow the cookie: names of senders and types, the UDP port, log
// files. Decoders return nothing for an invalid payload.

// Sender and type descriptions: int32 strlen + 1, the name, NUL. 1 to name_limit - 1 printable characters.
std::optional<std::string_view> decode_name(ByteView payload);
void encode_name(Bytes& out, std::string_view name);

// UDP description (its port is in the header's sender field): IPv4 text, NUL.
std::optional<std::string> decode_udp_host(ByteView payload);
void encode_udp_host(Bytes& out, std::string_view host);

// Whether a log description has the lengths it states. It is otherwise ignored.
bool is_valid_log_description(ByteView payload);

// "<ip> <tcp-port>\0": a client's UDP request that the server connect to it.
struct DialRequest {
  std::string host;  // letters, digits and '.'
  int port = 0;      // 1024..65535
};
std::optional<DialRequest> decode_dial_request(ByteView datagram);
void encode_dial_request(Bytes& out, const DialRequest& request);

inline bool is_valid_port(std::int64_t port) {
  return port >= 1024 && port <= 65535;
}

}  // namespace intaglio::haptics::vrpn
