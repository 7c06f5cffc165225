// Why a link is not there, or no longer.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "haptics/vrpn/message.h"
#include "intaglio/error.h"

namespace intaglio::haptics::vrpn {

enum class LinkFault {
  none,
  unreachable,  // no such host, or no way to it
  refused,      // the host has nobody at that port
  timed_out,    // no answer
  not_vrpn,     // somebody answers, in another language
  closed,       // the peer ended the link
  bad_frames,   // three of the peer's frames could not be believed
  too_slow,     // a message or a cookie took the peer too long
  not_reading,  // what we send piles up
  port_taken,   // another program serves that port
  stopped,      // we were asked to stop
};

std::string_view meaning(LinkFault fault);

// For people and for exit codes.
struct LinkFailure {
  LinkFault fault = LinkFault::none;
  Error error;
};

template <class T>
using Linked = tl::expected<T, LinkFailure>;

inline tl::unexpected<LinkFailure> link_failure(LinkFault fault, std::string where, std::string fix = {}) {
  return tl::unexpected<LinkFailure>(
      LinkFailure{fault, Error{std::move(where), std::string(meaning(fault)), std::move(fix)}});
}

// IPv4 sockets that never block: the few calls that VRPN needs. A Socket closes itself. Any thread; one
// socket, one thread at a time.

class Socket {
 public:
  Socket() = default;
  explicit Socket(int fd) : fd_(fd) {}
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Socket();

  int fd() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

inline constexpr std::uint32_t loopback_host = 0x7f000001;

struct Ipv4 {
  std::uint32_t host = 0;  // host byte order; 0: any
  int port = 0;            // 0: any

  std::string host_text() const;  // "127.0.0.1"
  std::string text() const;       // "127.0.0.1:3883"
  // Reached from this machine alone.
  bool loopback() const { return host >> 24 == 127; }
};

// By name or number; may ask the name service, and then blocks.
Linked<Ipv4> resolve(const std::string& host, int port);
// A number only; never blocks.
std::optional<Ipv4> parse_ipv4(const std::string& host, int port);

Linked<Socket> listen_tcp(const Ipv4& at);
Linked<Socket> bind_udp(const Ipv4& at);
// Sends to and hears from `to` only.
Linked<Socket> connect_udp(const Ipv4& to);
// Starts to connect; writable means connected or failed: ask pending_fault().
Linked<Socket> dial_tcp(const Ipv4& to, std::uint32_t from_host = 0);
LinkFault pending_fault(const Socket& socket);
bool is_connected(const Socket& socket);

struct Accepted {
  Socket socket;
  Ipv4 peer;
};
std::optional<Accepted> accept_tcp(const Socket& listener);
Ipv4 local_address(const Socket& socket);

// To where a UDP socket is connected. Refused when an earlier one met a closed port.
LinkFault send_datagram(const Socket& udp, View bytes);

struct Datagram {
  View bytes;  // of the buffer that was lent
  Ipv4 from;
};
// The next datagram that has come, cut to the buffer; none when none has.
std::optional<Datagram> receive(const Socket& udp, std::span<std::uint8_t> buffer);

// Waits until one of two sockets can be read (or the first be written, when asked); either may be absent.
void wait_for(const Socket& first, const Socket& second, bool first_writable, std::int64_t nanoseconds);

}  // namespace intaglio::haptics::vrpn
