// IPv4 sockets that never block: the few calls that VRPN needs. A Socket closes itself. Any thread; one
// socket, one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "intaglio/haptics/devices/vrpn/link_fault.h"
#include "intaglio/haptics/devices/vrpn/wire.h"

namespace intaglio::haptics::vrpn {

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
