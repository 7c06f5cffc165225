#include "haptics/vrpn/client.h"

#include <fmt/format.h>
#include <charconv>

#include "haptics/vrpn/message.h"

namespace intaglio::haptics::vrpn {

std::string Address::text() const {
  return fmt::format("{}@{}:{}", name, host, port);
}

namespace {

constexpr std::string_view tcp_scheme = "tcp://";

}  // namespace

Result<Address> parse_address(std::string_view text) {
  const auto wrong = [&](const char* what) {
    return fail(std::string(text), what, "write NAME@HOST[:PORT], for example Phantom0@localhost");
  };
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos || at == 0) return wrong("no name before an '@'");
  Address address;
  address.name = text.substr(0, at);
  if (address.name.size() >= name_limit) return wrong("the name is too long");
  std::string_view host = text.substr(at + 1);
  if (host.starts_with(tcp_scheme)) {
    address.tcp_only = true;
    host.remove_prefix(tcp_scheme.size());
  }
  const std::size_t colon = host.find(':');
  if (colon != std::string_view::npos) {
    const std::string_view digits = host.substr(colon + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), address.port);
    if (error != std::errc() || end != digits.data() + digits.size() || address.port < 1 ||
        address.port > 65535)
      return wrong("the port must be a number from 1 to 65535");
    host = host.substr(0, colon);
  }
  address.host = host;
  if (address.host.empty()) return wrong("no host after the '@'");
  return address;
}

using std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds poll_interval{20};  // of `stopped`
constexpr std::chrono::seconds retry_interval{1};       // of requests and pings

// Advice to the user.
std::string advice(LinkFault fault, const Address& address) {
  switch (fault) {
    case LinkFault::refused:
    case LinkFault::timed_out:
      return address.tcp_only ? "is the server running, at that port?"
                              : "is the server running, at that port? Behind a firewall try --tcp";
    case LinkFault::not_vrpn:
      return "another program serves that port, or the server has no room for another client";
    default:
      return "";
  }
}

tl::unexpected<LinkError> failed(LinkFault fault, const Address& address) {
  return link_error(fault, address.text(), advice(fault, address));
}

// When to give up connecting.
struct Deadline {
  const ClientOptions& options;
  SteadyTime end = steady_clock::now() + options.patience;

  LinkFault check() const {
    if (options.stopped && *options.stopped) return LinkFault::stopped;
    return steady_clock::now() < end ? LinkFault::none : LinkFault::timed_out;
  }
};

LinkResult<Socket> dial(const Address& address, const Ipv4& server, const ClientOptions& options) {
  LinkResult<Socket> socket = dial_tcp(server);
  if (!socket) return failed(socket.error().fault, address);
  const Deadline deadline{options};
  for (;;) {
    wait_for(*socket, {}, true, std::chrono::nanoseconds(poll_interval).count());
    if (is_connected(*socket)) return socket;
    LinkFault fault = pending_fault(*socket);
    if (fault == LinkFault::none) fault = deadline.check();
    if (fault != LinkFault::none) return failed(fault, address);
  }
}

// Asks the server to connect to us, and waits until it does.
LinkResult<Accepted> request(const Address& address, const Ipv4& server, const ClientOptions& options) {
  LinkResult<Socket> udp = connect_udp(server);
  if (!udp) return failed(udp.error().fault, address);
  const std::uint32_t our_host = local_address(*udp).host;
  LinkResult<Socket> listener = listen_tcp({our_host, 0});
  if (!listener) return failed(listener.error().fault, address);
  Bytes datagram;
  encode_dial_request(datagram, {Ipv4{our_host, 0}.host_text(), local_address(*listener).port});
  const Deadline deadline{options};
  SteadyTime next_request = steady_clock::now();
  for (;;) {
    LinkFault fault = deadline.check();
    if (fault == LinkFault::none && steady_clock::now() >= next_request) {
      next_request += retry_interval;
      fault = send_datagram(*udp, datagram);
    }
    wait_for(*listener, *udp, false, std::chrono::nanoseconds(poll_interval).count());
    if (fault == LinkFault::none) fault = pending_fault(*udp);
    if (fault != LinkFault::none) return failed(fault, address);
    while (auto call = accept_tcp(*listener))
      if (call->peer.host == server.host) return std::move(*call);
  }
}

}  // namespace

LinkResult<std::unique_ptr<Client>> Client::connect(const Address& address, const ClientOptions& options) {
  LinkResult<Ipv4> server = resolve_unless(options.stopped, address.host, address.port, options.resolver);
  if (!server) return tl::unexpected(server.error());
  Socket tcp;
  if (address.tcp_only) {
    LinkResult<Socket> dialled = dial(address, *server, options);
    if (!dialled) return tl::unexpected(dialled.error());
    tcp = std::move(*dialled);
  } else {
    LinkResult<Accepted> call = request(address, *server, options);
    if (!call) return tl::unexpected(call.error());
    tcp = std::move(call->socket);
  }
  auto client = std::make_unique<Client>(address, std::move(tcp), *server, steady_clock::now());
  const Deadline deadline{options};
  while (!client->connection_.is_established()) {
    client->step(poll_interval, nullptr);  // leaves the device's messages to the caller
    LinkFault fault = client->fault();
    if (fault == LinkFault::too_slow) fault = LinkFault::timed_out;
    // It hung up before it sent a cookie.
    if (fault == LinkFault::closed) fault = LinkFault::not_vrpn;
    if (fault == LinkFault::none && !client->connection_.is_established()) fault = deadline.check();
    if (fault != LinkFault::none) return failed(fault, address);
  }
  return client;
}

Client::Client(const Address& address, Socket tcp, const Ipv4& peer, SteadyTime now)
    : address_(address),
      connection_(std::move(tcp), peer,
                  ConnectionOptions{.senders = {"VRPN Control", address.name}, .udp = !address.tcp_only},
                  now) {}

void Client::step(std::chrono::nanoseconds patience, const Connection::Handler& handler) {
  if (patience.count() > 0)
    wait_for(connection_.tcp(), connection_.udp(), connection_.wants_to_write(), patience.count());
  step_at(steady_clock::now(), handler);
}

void Client::step_at(SteadyTime now, const Connection::Handler& handler) {
  ping(now);
  if (!handler) return connection_.step(now, nullptr);
  connection_.step(now, [&](const Received& received) {
    if (received.sender != address_.name) return true;
    if (received.type == Type::pong) {
      answered_ = true;
      return received.payload.empty();
    }
    return handler(received);
  });
}

void Client::ping(SteadyTime now) {
  if (answered_ || !connection_.is_established() || (pinged_ && now - last_ping_ < retry_interval)) return;
  if (!pinged_) first_ping_ = now;
  pinged_ = true;
  last_ping_ = now;
  send(Type::ping, {}, Channel::reliable);
}

std::chrono::nanoseconds Client::ping_age() const {
  if (answered_ || !pinged_) return {};
  return steady_clock::now() - first_ping_;
}

}  // namespace intaglio::haptics::vrpn
