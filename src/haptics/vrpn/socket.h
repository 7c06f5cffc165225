// IPv4 sockets that never block: the few calls that VRPN needs; and the faults of a link.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "haptics/vrpn/message.h"
#include "intaglio/error.h"

namespace intaglio::haptics::vrpn {

// Why a link is down.
enum class LinkFault {
  none,
  unreachable,  // host not found, or no route
  refused,      // no listener at that port
  timed_out,    // no answer
  not_vrpn,     // the peer does not speak VRPN
  closed,       // the peer ended the link
  bad_frames,   // three malformed frames
  too_slow,     // a message or a cookie took too long to arrive
  not_reading,  // the peer does not read its socket
  idle,         // it has neither sent nor read anything for long
  crowded,      // it said nothing while others wanted its place
  port_taken,   // another program serves that port
  stopped,      // by our caller
};

std::string_view describe(LinkFault fault);

// The error is for people, the fault for exit codes.
struct LinkError {
  LinkFault fault = LinkFault::none;
  Error error;
};

template <class T>
using LinkResult = tl::expected<T, LinkError>;

inline tl::unexpected<LinkError> link_error(LinkFault fault, std::string where, std::string fix = {}) {
  return tl::unexpected<LinkError>(
      LinkError{fault, Error{std::move(where), std::string(describe(fault)), std::move(fix)}});
}

// Closes itself. Any thread, one at a time.
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
  // Reachable from this machine only.
  bool loopback() const { return host >> 24 == 127; }
  bool operator==(const Ipv4&) const = default;
};

// A number only; never blocks.
std::optional<Ipv4> parse_ipv4(const std::string& host, int port);
// A name or a number. Blocks for as long as the name service takes, which may be half a minute.
LinkResult<Ipv4> resolve(const std::string& host, int port);

// Returns an address for a host, as resolve() does; may block. Must not refer to anything that can be
// destroyed while it runs.
using Resolver = std::function<LinkResult<Ipv4>(const std::string& host, int port)>;

// Runs `resolver` until it answers, or until 20 ms after `stopped` is set (nullptr: never) at the latest.
//
// getaddrinfo() cannot be cancelled, and a thread that is in it must not be joined by a caller that has to
// return soon, such as a device's destructor in a window's thread. Names are therefore looked up on a
// detached thread. It owns copies of everything it uses and shares its result with the caller by a
// shared_ptr, so that an abandoned lookup refers to nothing of the caller's; it ends when the name service
// answers or gives up.
LinkResult<Ipv4> resolve_unless(const std::atomic<bool>* stopped, const std::string& host, int port,
                                const Resolver& resolver = resolve);

// TCP sockets hold little unsent data, so that a peer that does not read is noticed, and end by themselves
// half a minute after their peer has vanished without a word.
LinkResult<Socket> listen_tcp(const Ipv4& at);
LinkResult<Socket> bind_udp(const Ipv4& at);
// Sends to and receives from `to` only.
LinkResult<Socket> connect_udp(const Ipv4& to);
// Starts to connect; once writable it has connected or failed: see pending_fault().
LinkResult<Socket> dial_tcp(const Ipv4& to, std::uint32_t from_host = 0);
LinkFault pending_fault(const Socket& socket);
bool is_connected(const Socket& socket);

struct Accepted {
  Socket socket;
  Ipv4 peer;
};
std::optional<Accepted> accept_tcp(const Socket& listener);
Ipv4 local_address(const Socket& socket);

// To the address that a UDP socket is connected to. `refused` when an earlier datagram met a closed port.
LinkFault send_datagram(const Socket& udp, ByteView bytes);

struct Datagram {
  ByteView bytes;  // in the caller's buffer
  Ipv4 from;
};
// The next datagram received, truncated to the buffer; none when there is none.
std::optional<Datagram> receive(const Socket& udp, std::span<std::uint8_t> buffer);

// Waits until one of two sockets is readable, or the first is writable if `first_writable`; either may be
// absent.
void wait_for(const Socket& first, const Socket& second, bool first_writable, std::int64_t patience_ns);

}  // namespace intaglio::haptics::vrpn
