// Real sessions, as the project keeps them outside its tree: every message decodes, and encodes to the same
// bytes.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>

#include "haptics/vrpn/message.h"
#include "tests/haptics/vrpn_capture.h"
#include "tests/haptics/vrpn_reencode.h"
#include "tests/skipped.h"

using namespace intaglio;
using namespace intaglio::haptics::vrpn;

namespace {

// One direction of a session.
struct Side {
  Framer framer;
  PeerNames names;
  bool greeted = false;
  int messages = 0, unknown = 0;
  std::map<Type, int> count;

  void check(const Message& message);
  void feed(const Bytes& bytes);
};

void Side::check(const Message& message) {
  ++messages;
  std::optional<Bytes> again;
  if (message.type < 0) {
    again = reencode_system(message.type, message.payload);
    if (message.type == sender_description)
      CHECK(names.learn_sender(message.sender, *decode_name(message.payload)));
    if (message.type == type_description)
      CHECK(names.learn_type(message.sender, *decode_name(message.payload)));
    if (message.type == udp_description) CHECK(sound_port(message.sender));
  } else {
    CHECK_FALSE(names.sender(message.sender).empty());
    const auto type = names.type(message.type);
    if (!type) {
      ++unknown;
      return;
    }
    ++count[*type];
    again = reencode(*type, message.payload);
  }
  REQUIRE(again);
  CHECK(std::equal(again->begin(), again->end(), message.payload.begin(), message.payload.end()));
  // Header and payload as a whole; padding is not defined.
  Bytes whole;
  append_message(whole, message);
  const auto size = static_cast<std::ptrdiff_t>(header_size + message.payload.size());
  CHECK(std::equal(whole.begin(), whole.begin() + size, message.payload.data() - header_size));
}

void Side::feed(const Bytes& bytes) {
  framer.feed(bytes);
  if (!greeted) {
    const View cookie = framer.take(cookie_size);
    if (cookie.empty()) return;
    greeted = true;
    CHECK(read_cookie(cookie).match == CookieMatch::same);
    CHECK(std::equal(cookie.begin(), cookie.end(), our_cookie().begin()));
  }
  while (const auto message = framer.next()) check(*message);
}

}  // namespace

TEST_CASE("every message of the captured sessions decodes, and encodes to the same bytes") {
  struct Expected {
    std::string file;
    int poses, forces, planes, changes;
  };
  for (const Expected& expected : {Expected{"phantom-session-udp-request.jsonl", 149, 149, 0, 1},
                                   Expected{"phantom-plane-session-tcp.jsonl", 51, 72, 22, 1},
                                   Expected{"stock-server-tcp.jsonl", 453, 0, 0, 6}}) {
    CAPTURE(expected.file);
    const std::vector<Chunk> chunks = read_capture(expected.file);
    if (chunks.empty()) {
      tests::skipped("no captures in ../shared/vrpn/captures");
      continue;
    }
    std::map<std::string, Side> sides;
    for (const Chunk& chunk : chunks) {
      if (chunk.channel == "udp-request") {
        const auto request = decode_dial_request(chunk.bytes);
        REQUIRE(request);
        Bytes again;
        encode_dial_request(again, *request);
        CHECK(again == chunk.bytes);
      } else {
        sides[chunk.from].feed(chunk.bytes);
      }
    }
    Side &server = sides["server"], &client = sides["client"];
    for (const Side* side : {&server, &client}) {
      CHECK(side->framer.waiting() == 0);
      CHECK(side->framer.bad_frames() == 0);
      CHECK(side->unknown == 0);
    }
    CHECK(server.count[Type::pos_quat] == expected.poses);
    CHECK(server.count[Type::velocity] == expected.poses);
    CHECK(server.count[Type::force] == expected.forces);
    CHECK(client.count[Type::plane] == expected.planes);
    CHECK(server.count[Type::button_change] == expected.changes);
    MESSAGE(expected.file << ": " << server.messages + client.messages << " messages");
  }
}

TEST_CASE("however the network cuts a captured stream, the messages are the same") {
  const Bytes stream = stream_of("phantom-plane-session-tcp.jsonl", "server");
  if (stream.empty()) {
    tests::skipped("no captures in ../shared/vrpn/captures");
    return;
  }
  Side whole;
  whole.feed(stream);
  for (const std::size_t piece : {1u, 7u, 24u, 1000u}) {
    Side cut;
    for (std::size_t at = 0; at < stream.size(); at += piece)
      cut.feed({stream.begin() + static_cast<std::ptrdiff_t>(at),
                stream.begin() + static_cast<std::ptrdiff_t>(std::min(at + piece, stream.size()))});
    CHECK(cut.messages == whole.messages);
    CHECK(cut.count == whole.count);
  }
}
