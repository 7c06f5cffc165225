// Captured sessions of real VRPN programs, which the project keeps outside its tree: every message decodes
// and encodes to the same bytes, and our client and server understand them over real sockets.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>

#include "haptics/vrpn/message.h"
#include "tests/haptics/vrpn_peers.h"
#include "tests/haptics/vrpn_reencode.h"
#include "tests/skipped.h"
#include "tests/source_folder.h"

using namespace intaglio;
using namespace intaglio::haptics;
using namespace intaglio::haptics::vrpn;

namespace {

struct Chunk {
  std::string from, channel;
  Bytes bytes;
};

// The value of a key in a line of a capture; no value there contains a quote or an escape.
std::string value_of(const std::string& line, const std::string& key) {
  const std::size_t at = line.find("\"" + key + "\": \"");
  if (at == std::string::npos) return {};
  const std::size_t start = at + key.size() + 5;
  return line.substr(start, line.find('"', start) - start);
}

// Empty where the captures are absent.
std::vector<Chunk> read_capture(const std::string& name) {
  std::ifstream file(std::string(tests::shared_folder) + "/vrpn/captures/" + name);
  std::vector<Chunk> chunks;
  for (std::string line; std::getline(file, line);) {
    Chunk chunk{value_of(line, "from"), value_of(line, "channel"), {}};
    const std::string hex = value_of(line, "hex");
    for (std::size_t k = 0; k + 1 < hex.size(); k += 2)
      chunk.bytes.push_back(std::uint8_t(std::stoi(hex.substr(k, 2), nullptr, 16)));
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

// Everything that one side sent by TCP.
Bytes stream_of(const std::string& capture, std::string_view side) {
  Bytes stream;
  for (const Chunk& chunk : read_capture(capture))
    if (chunk.from == side && chunk.channel == "tcp")
      stream.insert(stream.end(), chunk.bytes.begin(), chunk.bytes.end());
  return stream;
}

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
    if (message.type == udp_description) CHECK(is_valid_port(message.sender));
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
  const auto size = std::ptrdiff_t(header_size + message.payload.size());
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

TEST_CASE("a captured stream gives the same messages however the network cuts it") {
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
      cut.feed({stream.begin() + std::ptrdiff_t(at),
                stream.begin() + std::ptrdiff_t(std::min(at + piece, stream.size()))});
    CHECK(cut.messages == whole.messages);
    CHECK(cut.count == whole.count);
  }
}

TEST_CASE("our client understands a captured server") {
  struct Expected {
    std::string file, name;
    int poses, forces;
  };
  for (const Expected& expected : {Expected{"phantom-session-udp-request.jsonl", "Tracker0", 149, 149},
                                   Expected{"phantom-plane-session-tcp.jsonl", "Tracker0", 51, 72},
                                   Expected{"stock-server-tcp.jsonl", "Spin0", 279, 0}}) {
    CAPTURE(expected.file);
    const Bytes stream = stream_of(expected.file, "server");
    if (stream.empty()) {
      tests::skipped("no captures in ../shared/vrpn/captures");
      continue;
    }
    const Socket listener = std::move(*listen_tcp({loopback_host, 0}));
    std::atomic<bool> over{false};
    std::thread server([&] {
      std::optional<Accepted> call;
      if (!eventually([&] { return (call = accept_tcp(listener)).has_value(); })) return;
      std::size_t at = 0;
      eventually([&] {
        const ssize_t size = ::send(call->socket.fd(), stream.data() + at, stream.size() - at, MSG_NOSIGNAL);
        if (size > 0) at += std::size_t(size);
        return at == stream.size();
      });
      eventually([&] { return over.load(); });
    });
    auto client = Client::connect({expected.name, "127.0.0.1", local_address(listener).port, true});
    REQUIRE(client);
    int poses = 0, forces = 0;
    const auto hear = [&](const Received& received) {
      if (received.type == Type::pos_quat) poses += decode_pos_quat(received.payload).has_value();
      if (received.type == Type::force) forces += decode_force(received.payload).has_value();
      return true;
    };
    CHECK(eventually([&] {
      (*client)->step(std::chrono::milliseconds(1), hear);
      return poses >= expected.poses && forces >= expected.forces;
    }));
    over = true;
    server.join();
    CHECK(poses == expected.poses);
    CHECK(forces == expected.forces);
    CHECK((*client)->connection().bad_frames() == 0);
    // The capture includes pongs to Tracker0 only.
    CHECK(((*client)->ping_age().count() == 0) == (expected.name == "Tracker0"));
  }
}

TEST_CASE("our server obeys a captured client") {
  struct Expected {
    std::string file;
    int forces;
  };
  for (const Expected& expected :
       {Expected{"phantom-session-udp-request.jsonl", 0}, Expected{"phantom-plane-session-tcp.jsonl", 22},
        Expected{"stock-server-tcp.jsonl", 0}}) {
    CAPTURE(expected.file);
    const Bytes stream = stream_of(expected.file, "client");
    if (stream.empty()) {
      tests::skipped("no captures in ../shared/vrpn/captures");
      continue;
    }
    ServerOptions options;
    options.name = "Tracker0";
    RunningServer server(options);
    RawPeer peer(server.port);
    REQUIRE(peer.write(stream));
    CHECK(peer.kept());
    CHECK(server.ask([](Server& s) { return s.force_messages(); }) == expected.forces);
  }
}
