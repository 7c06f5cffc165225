#include "haptics/vrpn/socket.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace intaglio::haptics::vrpn {

std::string_view meaning(LinkFault fault) {
  switch (fault) {
    case LinkFault::none:
      return "linked";
    case LinkFault::unreachable:
      return "the host cannot be reached";
    case LinkFault::refused:
      return "connection refused";
    case LinkFault::timed_out:
      return "no answer";
    case LinkFault::not_vrpn:
      return "this is not a VRPN peer of version 07";
    case LinkFault::closed:
      return "the peer closed the link";
    case LinkFault::bad_frames:
      return "dropped after three bad frames";
    case LinkFault::too_slow:
      return "dropped: a message took too long to arrive";
    case LinkFault::not_reading:
      return "dropped: the peer does not read what it is sent";
    case LinkFault::port_taken:
      return "the port is taken";
    case LinkFault::stopped:
      return "stopped";
  }
  return "";
}

Socket::~Socket() {
  if (fd_ >= 0) ::close(fd_);
}

static sockaddr_in address_of(const Ipv4& at) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(at.host);
  address.sin_port = htons(static_cast<std::uint16_t>(at.port));
  return address;
}

static Ipv4 ipv4_of(const sockaddr_in& address) {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

static LinkFault fault_of(int error) {
  switch (error) {
    case 0:
    case EAGAIN:
    case EINPROGRESS:
      return LinkFault::none;
    case ECONNREFUSED:
      return LinkFault::refused;
    case ETIMEDOUT:
      return LinkFault::timed_out;
    case EADDRINUSE:
      return LinkFault::port_taken;
    case ECONNRESET:
    case EPIPE:
      return LinkFault::closed;
    default:
      return LinkFault::unreachable;
  }
}

static tl::unexpected<LinkFailure> failed(const Ipv4& at) {
  const int error = errno;
  const LinkFault fault = fault_of(error);
  return link_failure(fault, at.text(), fault == LinkFault::unreachable ? std::strerror(error) : "");
}

static Socket open_socket(int type) {
  return Socket(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

static bool bind_to(const Socket& socket, const Ipv4& at) {
  const sockaddr_in address = address_of(at);
  return ::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

static bool connect_to(const Socket& socket, const Ipv4& to) {
  const sockaddr_in address = address_of(to);
  return ::connect(socket.fd(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
         errno == EINPROGRESS;
}

static void set(const Socket& socket, int level, int option) {
  const int on = 1;
  ::setsockopt(socket.fd(), level, option, &on, sizeof on);
}

std::string Ipv4::host_text() const {
  return fmt::format("{}.{}.{}.{}", host >> 24, host >> 16 & 255, host >> 8 & 255, host & 255);
}

std::string Ipv4::text() const {
  return fmt::format("{}:{}", host_text(), port);
}

std::optional<Ipv4> parse_ipv4(const std::string& host, int port) {
  in_addr number{};
  if (::inet_pton(AF_INET, host.c_str(), &number) != 1) return std::nullopt;
  return Ipv4{ntohl(number.s_addr), port};
}

Linked<Ipv4> resolve(const std::string& host, int port) {
  if (const auto number = parse_ipv4(host, port)) return *number;
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (error != 0 || !found)
    return link_failure(LinkFault::unreachable, host,
                        fmt::format("no IPv4 address: {}", ::gai_strerror(error)));
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  ::freeaddrinfo(found);
  return Ipv4{ntohl(address.sin_addr.s_addr), port};
}

Linked<Socket> listen_tcp(const Ipv4& at) {
  Socket socket = open_socket(SOCK_STREAM);
  set(socket, SOL_SOCKET, SO_REUSEADDR);
  if (!socket || !bind_to(socket, at) || ::listen(socket.fd(), 16) != 0) return failed(at);
  return socket;
}

Linked<Socket> bind_udp(const Ipv4& at) {
  Socket socket = open_socket(SOCK_DGRAM);
  if (!socket || !bind_to(socket, at)) return failed(at);
  return socket;
}

Linked<Socket> connect_udp(const Ipv4& to) {
  Socket socket = open_socket(SOCK_DGRAM);
  if (!socket || !connect_to(socket, to)) return failed(to);
  return socket;
}

Linked<Socket> dial_tcp(const Ipv4& to, std::uint32_t from_host) {
  Socket socket = open_socket(SOCK_STREAM);
  set(socket, IPPROTO_TCP, TCP_NODELAY);
  if (!socket || (from_host != 0 && !bind_to(socket, {from_host, 0})) || !connect_to(socket, to))
    return failed(to);
  return socket;
}

LinkFault pending_fault(const Socket& socket) {
  int error = 0;
  socklen_t size = sizeof error;
  if (::getsockopt(socket.fd(), SOL_SOCKET, SO_ERROR, &error, &size) != 0) return LinkFault::unreachable;
  return fault_of(error);
}

bool is_connected(const Socket& socket) {
  sockaddr_in peer{};
  socklen_t size = sizeof peer;
  return ::getpeername(socket.fd(), reinterpret_cast<sockaddr*>(&peer), &size) == 0;
}

std::optional<Accepted> accept_tcp(const Socket& listener) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  Socket socket(
      ::accept4(listener.fd(), reinterpret_cast<sockaddr*>(&address), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket) return std::nullopt;
  set(socket, IPPROTO_TCP, TCP_NODELAY);
  return Accepted{std::move(socket), ipv4_of(address)};
}

Ipv4 local_address(const Socket& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket.fd(), reinterpret_cast<sockaddr*>(&address), &size);
  return ipv4_of(address);
}

LinkFault send_datagram(const Socket& udp, View bytes) {
  return ::send(udp.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0 ? fault_of(errno) : LinkFault::none;
}

std::optional<Datagram> receive(const Socket& udp, std::span<std::uint8_t> buffer) {
  sockaddr_in from{};
  socklen_t from_size = sizeof from;
  const ssize_t size =
      ::recvfrom(udp.fd(), buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &from_size);
  if (size < 0) return std::nullopt;
  return Datagram{buffer.first(static_cast<std::size_t>(size)), ipv4_of(from)};
}

void wait_for(const Socket& first, const Socket& second, bool first_writable, std::int64_t nanoseconds) {
  // poll() leaves out negative descriptors.
  pollfd polled[2] = {{first.fd(), static_cast<short>(POLLIN | (first_writable ? POLLOUT : 0)), 0},
                      {second.fd(), POLLIN, 0}};
  const timespec patience{nanoseconds / 1000000000, nanoseconds % 1000000000};
  ::ppoll(polled, 2, &patience, nullptr);
}

}  // namespace intaglio::haptics::vrpn
