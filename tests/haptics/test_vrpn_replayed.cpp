// The bytes of real VRPN programs, played to our client and to our server over real sockets.
#include <doctest/doctest.h>

#include "haptics/vrpn/force.h"
#include "tests/haptics/vrpn_capture.h"
#include "tests/haptics/vrpn_peers.h"
#include "tests/skipped.h"

using namespace intaglio;
using namespace intaglio::haptics;
using namespace intaglio::haptics::vrpn;

TEST_CASE("our client hears what a captured server said") {
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
        if (size > 0) at += static_cast<std::size_t>(size);
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
    // Its pongs to Tracker0 are in the capture too.
    CHECK(((*client)->unanswered().count() == 0) == (expected.name == "Tracker0"));
  }
}

TEST_CASE("our server obeys what a captured client said") {
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
