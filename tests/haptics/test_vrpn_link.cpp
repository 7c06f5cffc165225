// Client and server over real sockets on this machine, by both transports; and how a server treats peers that
// break the rules.
#include <doctest/doctest.h>

#include <algorithm>

#include "haptics/vrpn/payloads.h"
#include "tests/haptics/vrpn_peers.h"

using namespace intaglio;
using namespace intaglio::haptics;
using namespace intaglio::haptics::vrpn;

namespace {

// Messages received by a client.
struct Heard {
  int poses = 0, velocities = 0, forces = 0, contacts = 0, changes = 0, states = 0;
  std::string texts;
  std::vector<ForceError> errors;
  Vec3 position = Vec3::Zero(), force = Vec3::Zero();

  bool take(const Received& received) {
    switch (received.type) {
      case Type::pos_quat:
        ++poses;
        position = decode_pos_quat(received.payload).value().position;
        return true;
      case Type::velocity:
        return ++velocities > 0 && decode_motion(received.payload);
      case Type::force:
        ++forces;
        force = decode_force(received.payload).value().newtons;
        return true;
      case Type::scp:
        return ++contacts > 0 && decode_scp(received.payload);
      case Type::button_change:
        return ++changes > 0 && decode_button_change(received.payload);
      case Type::button_states:
        return ++states > 0 && decode_button_states(received.payload)->size() == 2;
      case Type::text:
        texts += decode_text(received.payload).value().text;
        return true;
      case Type::force_error:
        errors.push_back(decode_force_error(received.payload).value());
        return true;
      default:
        return false;
    }
  }
};

template <class Condition>
bool listen(Client& client, Heard& heard, Condition condition) {
  const auto end = std::chrono::steady_clock::now() + test_patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end || client.fault() != LinkFault::none) return false;
    client.step(std::chrono::milliseconds(1), [&](const Received& received) { return heard.take(received); });
  }
  return true;
}

LinkFault failure(const Address& address) {
  const auto client = Client::connect(address, {std::chrono::milliseconds(300), nullptr});
  return client ? LinkFault::none : client.error().fault;
}

}  // namespace

TEST_CASE("client and server talk by both transports; by UDP request reports come as datagrams") {
  for (const bool tcp_only : {false, true}) {
    CAPTURE(tcp_only);
    RunningServer server;
    auto client = Client::connect(server.address(tcp_only));
    REQUIRE(client);
    Heard heard;
    CHECK(listen(**client, heard, [&] { return heard.poses > 50 && (*client)->ping_age().count() == 0; }));
    CHECK(heard.velocities > 40);
    CHECK(heard.forces > 40);
    CHECK(heard.contacts > 40);
    CHECK(heard.states > 0);
    CHECK(heard.position.norm() < 0.1);
    CHECK(heard.position.norm() > 0.001);
    const Connection& connection = (*client)->connection();
    CHECK(connection.bad_frames() == 0);
    CHECK((connection.datagrams_received() > 20) == !tcp_only);
    CHECK(connection.peer_names().senders() == std::vector<std::string>{"VRPN Control", "Phantom0"});
    // A force that is sent is reported back.
    CHECK(listen(**client, heard, [&] {
      Bytes payload;
      encode(payload, ForceReport{{0, 1, 0}});
      (*client)->send(Type::force, payload, Channel::low_latency);
      return heard.force.y() > 0.5;
    }));
    CHECK(heard.force.x() == 0);
    CHECK((*client)->connection().sends_udp() == !tcp_only);
  }
}

TEST_CASE("host names resolve to IPv4 addresses; an unknown host is unreachable") {
  RunningServer server;
  CHECK(failure({"Phantom0", "localhost", server.port, true}) == LinkFault::none);
  CHECK(failure({"Phantom0", "localhost", server.port, false}) == LinkFault::none);
  CHECK(failure({"Phantom0", "no-such-host.invalid", server.port, true}) == LinkFault::unreachable);
}

TEST_CASE("a client distinguishes no listener, no answer, and another protocol") {
  const auto free_port = [] { return local_address(*listen_tcp({loopback_host, 0})).port; };
  CHECK(failure({"Phantom0", "127.0.0.1", free_port(), true}) == LinkFault::refused);
  CHECK(failure({"Phantom0", "127.0.0.1", free_port(), false}) == LinkFault::refused);
  const Socket silent_udp = std::move(*bind_udp({loopback_host, 0}));
  CHECK(failure({"Phantom0", "127.0.0.1", local_address(silent_udp).port, false}) == LinkFault::timed_out);
  const Socket listener = std::move(*listen_tcp({loopback_host, 0}));
  const Address there{"Phantom0", "127.0.0.1", local_address(listener).port, true};
  CHECK(failure(there) == LinkFault::timed_out);
  std::thread other([&] {
    for (int k = 0; k < 2; ++k) {
      std::optional<Accepted> call;
      eventually([&] { return (call = accept_tcp(listener)).has_value(); });
      if (call) ::send(call->socket.fd(), "SSH-2.0-OpenSSH_9.2p1 Debian\r\n", 30, MSG_NOSIGNAL);
      eventually([] { return false; }, std::chrono::milliseconds(100));
    }
  });
  // The first connection in the queue is the one that timed out above.
  CHECK(failure(there) == LinkFault::not_vrpn);
  other.join();
}

TEST_CASE("a server reports a port that is taken") {
  RunningServer server;
  ServerOptions options;
  options.port = server.port;
  const auto second = Server::open(options);
  REQUIRE_FALSE(second);
  CHECK(second.error().fault == LinkFault::port_taken);
}

TEST_CASE("a peer is dropped after three malformed frames, not after two") {
  Bytes nan = framed(Type::force, ForceReport{{0, std::numeric_limits<double>::quiet_NaN(), 0}});
  Bytes plane = framed(Type::plane, PlaneMessage{.a = 0, .b = 1, .index = 4});
  Bytes length;
  append_message(length, {{}, 0, 0, 0, {}});
  length[3] = 23;  // less than a header
  Bytes huge = length, negative = length;
  huge[1] = 1;  // 65,559
  negative[0] = 0x80;
  Bytes name;
  append_message(name, {{}, 0, sender_description, 0, Bytes{0x7f, 0xff, 0xff, 0xff, 'x', 0}});
  Bytes id;
  {
    Bytes payload;
    encode_name(payload, "Tracker0");
    append_message(id, {{}, 1 << 30, sender_description, 0, payload});
  }
  Bytes system;
  append_message(system, {{}, 0, -77, 0, {}});
  Bytes port;
  {
    Bytes payload;
    encode_udp_host(payload, "127.0.0.1");
    append_message(port, {{}, 1023, udp_description, 0, payload});
  }
  RunningServer server;
  int dropped = 0;
  for (const Bytes& bad : {nan, plane, length, huge, negative, name, id, system, port}) {
    RawPeer peer(server.port);
    REQUIRE(peer.greet());
    REQUIRE(peer.write(introduction()));
    REQUIRE(peer.write(bad));
    REQUIRE(peer.write(bad));
    CHECK(peer.kept());
    peer.write(bad);
    CHECK(peer.hung_up());
    ++dropped;
    CHECK(server.ask([](Server& s) { return s.dropped_for_bad_frames(); }) == dropped);
  }
}

TEST_CASE("an id that was never named is ignored") {
  RunningServer server;
  RawPeer peer(server.port);
  REQUIRE(peer.greet());
  for (int k = 0; k < 10; ++k) REQUIRE(peer.write(framed(Type::force, ForceReport{})));
  CHECK(peer.kept());
}

TEST_CASE("a peer is dropped for a missing or wrong cookie, and for a message that takes too long") {
  ServerOptions options;
  options.cookie_patience = options.message_patience = std::chrono::milliseconds(150);
  RunningServer server(options);
  RawPeer silent(server.port), wrong(server.port), dawdling(server.port), sound(server.port);
  REQUIRE(sound.greet());
  wrong.write(Bytes(24, 'G'));
  CHECK(wrong.hung_up());
  CHECK(silent.hung_up());
  REQUIRE(dawdling.greet());
  // Sending a byte now and then does not help.
  const Bytes message = framed(Type::force, ForceReport{});
  bool open = true;
  for (std::size_t k = 0; open && k < message.size() - 1; ++k) {
    open = dawdling.write(ByteView(message).subspan(k, 1)) && dawdling.kept(std::chrono::milliseconds(20));
  }
  CHECK_FALSE(open);
  CHECK(sound.kept());
}

TEST_CASE("a peer that never reads is dropped, and delays no other") {
  RunningServer server;
  RawPeer peer(server.port);
  REQUIRE(peer.greet());
  REQUIRE(peer.write(introduction()));
  const Socket deaf = std::move(*dial_tcp({loopback_host, server.port}));
  REQUIRE(eventually([&] { return is_connected(deaf); }));
  const auto cookie = our_cookie();
  Bytes pings(cookie.begin(), cookie.end());
  const Bytes names = introduction();
  pings.insert(pings.end(), names.begin(), names.end());
  for (int k = 0; k < 1000; ++k) append_message(pings, {{}, 0, std::int32_t(Type::ping), 0, {}});
  std::size_t at = 0;
  const bool dropped = eventually([&] {
    for (;;) {
      const ssize_t size = ::send(deaf.fd(), pings.data() + at, pings.size() - at, MSG_NOSIGNAL);
      if (size < 0) return errno != EAGAIN;
      at += std::size_t(size);
      if (at == pings.size()) at = cookie_size;
    }
  });
  CHECK(dropped);
  CAPTURE(server.log());
  CHECK(eventually([&] { return server.log().find(describe(LinkFault::not_reading)) != std::string::npos; }));
  CHECK(peer.kept());
}

TEST_CASE("a client beyond the limit is rejected, and the log says so") {
  ServerOptions options;
  options.max_clients = 6;
  RunningServer server(options);
  std::vector<std::unique_ptr<Client>> clients;
  for (int k = 0; k < 6; ++k) {
    auto client = Client::connect(server.address(k % 2 == 0));
    REQUIRE(client);
    clients.push_back(std::move(*client));
  }
  const auto all_hear_poses = [&] {
    for (auto& client : clients) {
      Heard heard;
      CHECK(listen(*client, heard, [&] { return heard.poses > 10; }));
    }
  };
  all_hear_poses();  // so that all are served
  CHECK(failure(server.address(true)) != LinkFault::none);
  CHECK(server.log().find("rejected: limit of 6 clients") != std::string::npos);
  all_hear_poses();
  // A free slot is used again.
  clients.pop_back();
  CHECK(eventually([&] { return failure(server.address(false)) == LinkFault::none; }));
}

TEST_CASE("one client at a time controls the force; another gets a message, and its turn later") {
  RunningServer server;
  auto first = std::move(*Client::connect(server.address(true)));
  auto second = std::move(*Client::connect(server.address(true)));
  const auto push = [](Client& client, double x) {
    Bytes payload;
    encode(payload, ForceReport{{x, 0, 0}});
    client.send(Type::force, payload, Channel::reliable);
  };
  Heard one, two;
  CHECK(listen(*first, one, [&] {
    push(*first, 1);
    return one.force.x() > 0.3;
  }));
  CHECK(listen(*second, two, [&] {
    push(*first, 1);
    push(*second, -1);
    first->step({}, [&](const Received& received) { return one.take(received); });
    return !two.texts.empty() && two.poses > 20;
  }));
  CHECK(two.force.x() > 0);
  first.reset();
  CHECK(listen(*second, two, [&] {
    push(*second, -1);
    return two.force.x() < -0.3;
  }));
}

TEST_CASE("requests to connect to another host, or to a port below 1024, are ignored") {
  RunningServer server;
  const Socket udp = std::move(*connect_udp({loopback_host, server.port}));
  const Socket listener = std::move(*listen_tcp({loopback_host, 0}));
  const std::string port = std::to_string(local_address(listener).port);
  const auto send = [&](const std::string& text) {
    const Bytes bytes(text.begin(), text.end());
    send_datagram(udp, bytes);
  };
  for (const std::string& text : std::vector<std::string>{
           "127.0.0.2 " + port, "127.0.0.1 80", "127.0.0.1;reboot " + port, "127.0.0.1 70000", "127.0.0.1 -1",
           "127.0.0.1 " + port + "x", "127.0.0.1", " ", ""})
    send(text + std::string(1, '\0'));
  send("127.0.0.1 " + port);  // no NUL
  CHECK_FALSE(eventually([&] { return accept_tcp(listener).has_value(); }, std::chrono::milliseconds(150)));
  send("127.0.0.1 " + port + std::string(1, '\0'));
  CHECK(eventually([&] { return accept_tcp(listener).has_value(); }));
}

TEST_CASE("a client sets the rate of its own reports") {
  RunningServer server;
  auto slow = std::move(*Client::connect(server.address(true)));
  auto fast = std::move(*Client::connect(server.address(true)));
  Heard slow_heard, fast_heard;
  Bytes payload;
  put(payload, 20.0);
  slow->send(Type::set_update_rate, payload, Channel::reliable);
  CHECK(listen(*slow, slow_heard, [&] { return slow_heard.poses > 5; }));
  slow_heard = {};
  CHECK(listen(*fast, fast_heard, [&] {
    slow->step({}, [&](const Received& received) { return slow_heard.take(received); });
    return fast_heard.poses > 400;
  }));
  CHECK(slow_heard.poses < fast_heard.poses / 4);
}

TEST_CASE(
    "a client that requests more than the peak gets a force error, and the force stays within the peak") {
  RunningServer server;
  auto client = std::move(*Client::connect(server.address(true)));
  Heard heard;
  double strongest = 0;
  const auto ask_for = [&](double newtons) {
    Bytes payload;
    encode(payload, ForceReport{{0, newtons, 0}});
    client->send(Type::force, payload, Channel::reliable);
    strongest = std::max(strongest, heard.force.norm());
  };
  CHECK(listen(*client, heard, [&] {
    ask_for(60);
    return heard.errors.size() == 1;
  }));
  CHECK(listen(*client, heard, [&] {
    ask_for(0.5);
    return heard.errors.size() == 2;
  }));
  CHECK(heard.errors == std::vector<ForceError>{ForceError::force_too_high, ForceError::ok});
  CHECK(strongest <= 7.9 + 1e-9);
}
