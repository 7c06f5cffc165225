// A VRPN device's address, and the client side of a link to it.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <string_view>

#include "haptics/vrpn/connection.h"
#include "haptics/vrpn/message.h"
#include "intaglio/error.h"

namespace intaglio::haptics::vrpn {

// NAME@HOST[:PORT], or NAME@tcp://HOST[:PORT] to use TCP only.
struct Address {
  std::string name;  // of the sender, for example "Phantom0"
  std::string host;
  int port = default_port;
  bool tcp_only = false;

  std::string text() const;  // "Phantom0@localhost:3883"
};

Result<Address> parse_address(std::string_view text);

// The client side of a link: dials a server by UDP request or by TCP only, pings it until it answers, and
// passes its messages to a handler.
//
// By UDP request we listen on TCP at the address that leads to the server, ask it once a second to connect,
// and accept connections from the server's address only. connect() blocks for up to its patience, plus the
// time that the name service takes, and returns within 20 ms of `stopped`; step() blocks for up to its
// timeout. One thread.

struct ClientOptions {
  std::chrono::milliseconds patience{3000};    // for the connection, and again for the cookie
  const std::atomic<bool>* stopped = nullptr;  // set by the caller to give up early
  Resolver resolver = resolve;                 // looks up the host's name
};

// Ids of our own senders, client and server alike: 0 "VRPN Control", 1 the device.
inline constexpr std::int32_t device_sender = 1;

class Client {
 public:
  static LinkResult<std::unique_ptr<Client>> connect(const Address& address,
                                                     const ClientOptions& options = {});

  // Over a socket that is connected to the server already.
  Client(const Address& address, Socket tcp, const Ipv4& peer, SteadyTime now);

  // Waits up to `patience` for something to do, then does it. The handler gets the device's messages.
  void step(std::chrono::nanoseconds patience, const Connection::Handler& handler);
  // Does what is due now, without waiting.
  void step_at(SteadyTime now, const Connection::Handler& handler);
  void send(Type type, const Bytes& payload, Channel channel) {
    connection_.send(type, device_sender, payload, channel);
  }

  const Connection& connection() const { return connection_; }
  LinkFault fault() const { return connection_.fault(); }
  // Time since the first ping without an answer; zero after any pong.
  std::chrono::nanoseconds ping_age() const;

 private:
  void ping(SteadyTime now);

  Address address_;
  Connection connection_;
  SteadyTime first_ping_, last_ping_;
  bool pinged_ = false, answered_ = false;
};

}  // namespace intaglio::haptics::vrpn
