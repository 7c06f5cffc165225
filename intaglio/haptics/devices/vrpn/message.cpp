#include "intaglio/haptics/devices/vrpn/message.h"

#include <cassert>
#include <chrono>

namespace intaglio::haptics::vrpn {

static std::size_t padded(std::size_t size) {
  return (size + 7) / 8 * 8;
}

Stamp Stamp::now() {
  const auto since = std::chrono::duration_cast<std::chrono::microseconds>(
                         std::chrono::system_clock::now().time_since_epoch())
                         .count();
  return {static_cast<std::int32_t>(since / 1000000), static_cast<std::int32_t>(since % 1000000)};
}

Taken take_message(View bytes) {
  if (bytes.size() < header_size) return {};
  Reader header(bytes.first(header_size));
  const std::int32_t length = header.i32();
  // Before any arithmetic on it.
  if (length < static_cast<std::int32_t>(header_size) || length > static_cast<std::int32_t>(message_limit))
    return {Frame::bad, header_size, {}};
  const auto size = static_cast<std::size_t>(length);
  if (bytes.size() < padded(size)) return {};
  Taken taken{Frame::whole, padded(size), {}};
  taken.message.time.seconds = header.i32();
  taken.message.time.microseconds = header.i32();
  taken.message.sender = header.i32();
  taken.message.type = header.i32();
  taken.message.sequence = header.i32();
  taken.message.payload = bytes.subspan(header_size, size - header_size);
  return taken;
}

void append_message(Bytes& out, const Message& message) {
  const std::size_t size = header_size + message.payload.size();
  assert(size <= message_limit);
  const std::size_t end = out.size() + padded(size);
  put(out, static_cast<std::int32_t>(size));
  put(out, message.time.seconds);
  put(out, message.time.microseconds);
  put(out, message.sender);
  put(out, message.type);
  put(out, message.sequence);
  out.insert(out.end(), message.payload.begin(), message.payload.end());
  out.resize(end);
}

}  // namespace intaglio::haptics::vrpn
