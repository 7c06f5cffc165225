// A million broken frames: into the framer and every decoder, and over a real socket into a running server.
// Fewer by default, all with INTAGLIO_SLOW=1.
#include <doctest/doctest.h>

#include <cstdlib>
#include <random>

#include "haptics/vrpn/message.h"
#include "tests/haptics/vrpn_peers.h"
#include "tests/haptics/vrpn_reencode.h"

using namespace intaglio;
using namespace intaglio::haptics;
using namespace intaglio::haptics::vrpn;

namespace {

using Twister = std::mt19937_64;

int sampled(int whole, int fraction) {
  return std::getenv("INTAGLIO_SLOW") ? whole : whole / fraction;
}

// A frame of a random type, usually valid, with a few bytes changed or cut off.
Bytes broken_frame(Twister& random) {
  const auto below = [&](std::size_t n) { return std::size_t(random() % n); };
  Bytes payload(below(4) == 0 ? below(200)
                              : std::array<std::size_t, 8>{0, 4, 8, 12, 24, 40, 56, 64}[below(8)]);
  for (std::uint8_t& byte : payload) byte = below(3) == 0 ? std::uint8_t(random()) : 0;
  const auto type = std::int32_t(below(type_names.size() + 6)) - 5;
  if (type < 0 && below(2) == 0) {
    payload.clear();
    encode_name(payload, type_names[below(type_names.size())]);
  }
  Bytes frame;
  append_message(frame, {{}, std::int32_t(below(3)), type, 0, payload});
  static constexpr std::uint8_t nasty[] = {0x00, 0x01, 0x7f, 0x80, 0xff, 0x18, 0xfa};
  for (std::size_t changes = below(4); changes > 0; --changes)
    frame[below(2) == 0 ? below(24) : below(frame.size())] = nasty[below(sizeof nasty)];
  if (below(16) == 0) frame.resize(below(frame.size()));
  return frame;
}

// Checks invariants of any message.
void check(const Message& message, PeerNames& names) {
  if (message.payload.size() > message_limit - header_size) std::abort();
  if (message.type < 0) {
    const auto name = decode_name(message.payload);
    if (name && message.type == sender_description) names.learn_sender(message.sender, *name);
    if (name && message.type == type_description) names.learn_type(message.sender, *name);
    decode_udp_host(message.payload);
    is_valid_log_description(message.payload);
    return;
  }
  names.sender(message.sender);
  names.type(message.type);
  for (std::size_t k = 0; k < type_names.size(); ++k) {
    const auto again = reencode(static_cast<Type>(k), message.payload);
    // A payload that decodes has the size of its type.
    if (again && again->size() != message.payload.size() && static_cast<Type>(k) != Type::text) std::abort();
  }
}

}  // namespace

TEST_CASE("broken frames neither crash the framer and the decoders nor decode to impossible values") {
  Twister random(1);
  const int frames = sampled(1000000, 10);
  Framer framer;
  PeerNames names;
  int messages = 0, bad_lengths = 0;
  for (int k = 0; k < frames; ++k) {
    // A wrong but valid length may swallow the frames after it: start a new stream now and then.
    if (k % 8 == 0) {
      bad_lengths += framer.bad_frames();
      framer = Framer();
    }
    framer.feed(broken_frame(random));
    while (const auto message = framer.next()) {
      check(*message, names);
      ++messages;
    }
    if (framer.waiting() > message_limit + 8) std::abort();
  }
  CHECK(messages > frames / 10);
  CHECK(bad_lengths > frames / 100);
  MESSAGE(frames << " frames: " << messages << " messages, " << bad_lengths << " bad lengths");
}

TEST_CASE(
    "a running server drops peers that send broken frames, keeps a valid client, and bounds the force") {
  Twister random(2);
  const int frames = sampled(1000000, 50);
  RunningServer server;
  auto sound = std::move(*Client::connect(server.address(true)));
  std::optional<RawPeer> peer;
  int peers = 0, sent = 0;
  while (sent < frames) {
    if (!peer) {
      peer.emplace(server.port);
      peer->greet();
      peer->write(introduction());
      ++peers;
    }
    Bytes burst;
    for (int k = 0; k < 8; ++k, ++sent) {
      const Bytes frame = broken_frame(random);
      burst.insert(burst.end(), frame.begin(), frame.end());
    }
    // The server writes, too, and would drop a peer that never reads.
    if (!peer->write(burst) || !peer->read()) peer.reset();
    sound->step({}, [](const Received&) { return true; });
  }
  peer.reset();
  int poses = 0;
  CHECK(eventually([&] {
    sound->step({}, [&](const Received& received) {
      poses += received.type == Type::pos_quat;
      return true;
    });
    return poses > 100;
  }));
  CHECK(sound->fault() == LinkFault::none);
  server.ask([&](Server& s) {
    CHECK(s.phantom().position.allFinite());
    CHECK(s.phantom().force.norm() <= 7.9);
    CHECK(s.dropped_for_bad_frames() > peers / 2);
  });
  MESSAGE(sent << " frames from " << peers << " peers, " << server.ask([](Server& s) {
    return s.dropped_for_bad_frames();
  }) << " dropped for bad frames");
}
