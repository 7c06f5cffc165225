// Crowds of silent, idle and greedy connections, over real sockets from several addresses of this machine, in
// a time of the test's own: none of them shuts out a client, new or old.
#include <doctest/doctest.h>

#include <algorithm>
#include <deque>
#include <string>

#include "haptics/vrpn/payloads.h"
#include "tests/haptics/vrpn_peers.h"

using namespace intaglio;
using namespace intaglio::haptics;
using namespace intaglio::haptics::vrpn;

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint32_t crowds_host = loopback_host + 1;  // 127.0.0.2
const std::vector<std::string> stock_senders = {"VRPN Control", "Phantom0"};

// A connected socket to the server.
Socket dialled(int port, std::uint32_t from) {
  Socket socket = std::move(*dial_tcp({loopback_host, port}, from));
  REQUIRE(eventually([&] { return is_connected(socket); }));
  return socket;
}

// A VRPN client as others are: it greets, introduces itself, and then listens only.
struct Listener {
  Connection connection;
  int poses = 0;

  Listener(int port, std::uint32_t from, SteadyTime now)
      : connection(dialled(port, from), {loopback_host, port}, {.senders = stock_senders}, now) {}
  void step(SteadyTime now) {
    connection.step(now, [this](const Received& received) {
      poses += received.type == Type::pos_quat;
      return true;
    });
  }
};

// A server and its clients, which take turns.
struct Party {
  std::vector<std::string> log;
  std::unique_ptr<Server> server;
  SteadyTime now = std::chrono::steady_clock::now();
  std::deque<Listener> listeners;

  explicit Party(ServerOptions options = {}) {
    options.port = 0;
    options.log = [this](const std::string& line) { log.push_back(line); };
    server = std::move(*Server::open(options));
  }
  Listener& invite(std::uint32_t from = loopback_host) {
    return listeners.emplace_back(server->port(), from, now);
  }
  void pass(milliseconds time, milliseconds turn = milliseconds(1)) {
    for (const SteadyTime end = now + time; now < end; now += turn) {
      server->step(now);
      for (Listener& listener : listeners) listener.step(now);
    }
  }
  // Whether a client is served within a tenth of a second; bytes need a moment between two sockets.
  bool serves(Listener& listener) {
    const int before = listener.poses;
    for (int k = 0; k < 100 && listener.connection.fault() == LinkFault::none; ++k) {
      pass(milliseconds(1));
      if (listener.poses > before + 5) return true;
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return false;
  }
  std::string whole_log() const {
    std::string text;
    for (const std::string& line : log) text += line + "\n";
    return text;
  }
};

// Sockets that say what they are given, and then neither send nor read.
std::vector<Socket> mute_crowd(Party& party, int size, std::uint32_t from, const Bytes& says) {
  std::vector<Socket> crowd;
  for (int k = 0; k < size; ++k) {
    crowd.push_back(dialled(party.server->port(), from));
    REQUIRE(::send(crowd.back().fd(), says.data(), says.size(), MSG_NOSIGNAL) == ssize_t(says.size()));
    party.pass(milliseconds(2));
  }
  return crowd;
}

Bytes greeting() {
  const auto cookie = our_cookie();
  return {cookie.begin(), cookie.end()};
}

Bytes greeting_and_introduction() {
  Bytes bytes = greeting();
  const Bytes names = introduction();
  bytes.insert(bytes.end(), names.begin(), names.end());
  return bytes;
}

}  // namespace

TEST_CASE("silent sockets that are opened anew all the time shut nobody out") {
  for (const std::uint32_t from : {loopback_host, crowds_host}) {
    Party party;
    Listener& old = party.invite();
    REQUIRE(party.serves(old));
    for (int round = 0; round < 3; ++round) {
      const auto crowd = mute_crowd(party, 100, from, {});
      CHECK(party.serves(party.invite()));
      party.pass(milliseconds(2900), milliseconds(10));
    }
    CHECK(party.serves(old));
    CHECK(party.server->clients() == 4);
  }
}

TEST_CASE("greeted clients that neither send nor read shut nobody out") {
  for (const Bytes& says : {greeting(), greeting_and_introduction()}) {
    Party party;
    Listener& old = party.invite();
    REQUIRE(party.serves(old));
    const auto crowd = mute_crowd(party, 60, loopback_host, says);
    // Reports fill their sockets first: how long that takes is the kernel's choice, 5 to 9 s have been seen.
    party.pass(seconds(20));
    CHECK(party.serves(party.invite()));
    CHECK(party.serves(party.invite(crowds_host)));
    CHECK(party.serves(old));
    CHECK(party.server->clients() <= 24);
  }
}

TEST_CASE("one address cannot be all clients, however well they behave") {
  Party party;
  for (int k = 0; k < 16; ++k) REQUIRE(party.serves(party.invite(crowds_host)));
  CHECK_FALSE(party.serves(party.invite(crowds_host)));
  CHECK(party.whole_log().find("rejected: limit of 16 clients from one address") != std::string::npos);
  CHECK(party.serves(party.invite()));
}

TEST_CASE("in a full house a client that is served keeps its place, and a newcomer is rejected") {
  Party party;
  for (std::uint32_t k = 0; k < 24; ++k) REQUIRE(party.serves(party.invite(loopback_host + k / 8)));
  Listener& newcomer = party.invite(loopback_host + 3);
  CHECK_FALSE(party.serves(newcomer));
  CHECK(newcomer.connection.fault() == LinkFault::closed);
  party.listeners.pop_back();
  for (Listener& listener : party.listeners) CHECK(party.serves(listener));
}

TEST_CASE(
    "a client that only listens stays; one that neither sends nor reads is dropped after half a minute") {
  Party party;
  Listener& listener = party.invite();
  const auto crowd = mute_crowd(party, 1, loopback_host, greeting_and_introduction());
  REQUIRE(party.serves(listener));
  CHECK(party.server->clients() == 2);
  party.pass(seconds(600), milliseconds(20));
  CHECK(party.server->clients() == 1);
  CHECK(party.serves(listener));
  CHECK(party.whole_log().find(describe(LinkFault::idle)) != std::string::npos);
}

TEST_CASE("a flood of connections leaves few lines in the log, and their number") {
  Party party;
  for (int k = 0; k < 10; ++k) {
    mute_crowd(party, 50, crowds_host, Bytes(24, 'G'));
    party.pass(milliseconds(2500), milliseconds(10));
  }
  party.pass(seconds(10), milliseconds(10));
  CHECK(party.log.size() <= 44);
  int counted = 0;
  for (const std::string& line : party.log) {
    if (line.starts_with("... and "))
      counted += std::stoi(line.substr(8));
    else
      ++counted;
  }
  CHECK(counted == 500);
  CHECK(party.whole_log().find(" more in the last 10 s") != std::string::npos);
}
