// Any bytes as a VRPN peer's stream (cookie, then frames) and as a datagram. Accepted messages are within
// their limits and encode to the bytes they came from; an accepted plane gives a finite force.
// fuzz/vrpn_session.cpp runs whole sessions.
#include <algorithm>

#include "fuzz/require.h"
#include "haptics/vrpn/client.h"
#include "haptics/vrpn/force.h"
#include "haptics/vrpn/message.h"
#include "tests/haptics/vrpn_reencode.h"

using namespace intaglio;
using namespace intaglio::haptics::vrpn;
using fuzz::require;

namespace {

bool same(ByteView a, ByteView b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

void learn(const Message& message, PeerNames& names) {
  const auto name = decode_name(message.payload);
  if (!name) return;
  require(!name->empty() && name->size() < name_limit);
  if (message.type == sender_description) names.learn_sender(message.sender, *name);
  if (message.type == type_description) names.learn_type(message.sender, *name);
}

void check_force(Type type, ByteView payload) {
  RequestedForce requested({1000, 1000});
  if (type == Type::plane)
    if (const auto plane = decode_plane(payload)) requested.set(*plane);
  if (type == Type::force_field)
    if (const auto field = decode_force_field(payload)) requested.set(*field);
  const Vec3 x(0.01, -0.02, 0.03);
  require(requested.newtons(x, {0.1, 0.2, -0.3}).allFinite());
  if (const auto contact = requested.contact(x)) require(contact->allFinite());
}

void examine(const Message& message, PeerNames& names) {
  require(message.payload.size() <= message_limit - header_size);
  if (message.type < 0) {
    learn(message, names);
    is_valid_log_description(message.payload);
    const auto again = reencode_system(message.type, message.payload);
    if (again) require(same(*again, message.payload));
    return;
  }
  names.sender(message.sender);
  const auto type = names.type(message.type);
  // Known by name, or by number: the fuzzer need not find a description first.
  const Type taken = type.value_or(static_cast<Type>(message.type % int(type_names.size())));
  const auto again = reencode(taken, message.payload);
  // The bytes after a sensor, and after a text's end, have no meaning.
  const bool loose = taken == Type::pos_quat || taken == Type::velocity || taken == Type::acceleration;
  if (again && taken != Type::text) {
    require(again->size() == message.payload.size());
    if (!loose) require(same(*again, message.payload));
  }
  check_force(taken, message.payload);
}

void examine_stream(ByteView bytes) {
  Framer framer;
  PeerNames names;
  // In pieces of uneven size, as the network cuts it.
  for (std::size_t at = 0, piece = 1; at < bytes.size(); piece = piece * 7 % 1459 + 1) {
    const ByteView cut = bytes.subspan(at, std::min(piece, bytes.size() - at));
    framer.feed(cut);
    at += cut.size();
    while (const auto message = framer.next()) examine(*message, names);
    require(framer.waiting() < message_limit + 1459);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ByteView bytes(data, size);
  if (size >= cookie_size && read_cookie(bytes.first(cookie_size)).match != CookieMatch::not_vrpn)
    examine_stream(bytes.subspan(cookie_size));
  else
    examine_stream(bytes);
  if (const auto request = decode_dial_request(bytes)) {
    require(is_valid_port(request->port) && !request->host.empty());
    require(request->host.find_first_not_of(
                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.") == std::string::npos);
  }
  if (const auto address = parse_address(text_of(bytes)))
    require(!address->host.empty() && !address->name.empty());
  return 0;
}
