// How people name a VRPN device: NAME@HOST[:PORT], or NAME@tcp://HOST[:PORT] to use TCP only.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <string_view>

#include "haptics/vrpn/connection.h"
#include "haptics/vrpn/message.h"
#include "intaglio/error.h"

namespace intaglio::haptics::vrpn {

struct Address {
  std::string name;  // of the sender, for example "Phantom0"
  std::string host;
  int port = default_port;
  bool tcp_only = false;

  std::string text() const;  // "Phantom0@localhost:3883"
};

Result<Address> parse_address(std::string_view text);

// The client side of a VRPN link: dials a server by UDP request or by TCP only, then pings it until it
// answers and hands over what it sends.
//
// By UDP request our side listens on TCP at the address that leads to the server, asks for the call once a
// second, and takes it from the server's address only. connect() blocks up to its patience (and as long as
// the name service takes); step() up to its timeout. One thread.

struct ClientOptions {
  std::chrono::milliseconds patience{3000};    // for the call, and again for the cookie
  const std::atomic<bool>* stopped = nullptr;  // set from outside to give up early
};

// Our senders, as both sides number their own: 0 "VRPN Control", 1 the device.
inline constexpr std::int32_t device_sender = 1;

class Client {
 public:
  static Linked<std::unique_ptr<Client>> connect(const Address& address, const ClientOptions& options = {});

  // Waits up to `patience` for something to do, then does it. The handler gets what the device sent.
  void step(std::chrono::nanoseconds patience, const Connection::Handler& handler);
  void send(Type type, const Bytes& payload, Channel channel) {
    connection_.send(type, device_sender, payload, channel);
  }

  const Connection& connection() const { return connection_; }
  LinkFault fault() const { return connection_.fault(); }
  // How long our pings have had no pong; zero once there was one.
  std::chrono::nanoseconds unanswered() const;

 private:
  Client(const Address& address, Socket tcp, const Ipv4& peer);
  void ping(SteadyTime now);

  Address address_;
  Connection connection_;
  SteadyTime first_ping_, last_ping_;
  bool pinged_ = false, answered_ = false;
};

}  // namespace intaglio::haptics::vrpn
