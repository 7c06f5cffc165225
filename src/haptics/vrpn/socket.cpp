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
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>

namespace intaglio::haptics::vrpn {

std::string_view describe(LinkFault fault) {
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
      return "not a VRPN peer of version 07";
    case LinkFault::closed:
      return "the peer closed the link";
    case LinkFault::bad_frames:
      return "dropped after three malformed frames";
    case LinkFault::too_slow:
      return "dropped: a message took too long to arrive";
    case LinkFault::not_reading:
      return "dropped: the peer does not read its socket";
    case LinkFault::idle:
      return "dropped: it neither sent nor read anything for long";
    case LinkFault::crowded:
      return "dropped: it was silent, and others wanted its place";
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

namespace {

sockaddr_in address_of(const Ipv4& at) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(at.host);
  address.sin_port = htons(std::uint16_t(at.port));
  return address;
}

Ipv4 ipv4_of(const sockaddr_in& address) {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

LinkFault fault_of(int error) {
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

tl::unexpected<LinkError> failed(const Ipv4& at) {
  const int error = errno;
  const LinkFault fault = fault_of(error);
  return link_error(fault, at.text(), fault == LinkFault::unreachable ? std::strerror(error) : "");
}

Socket open_socket(int type) {
  return Socket(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

bool bind_to(const Socket& socket, const Ipv4& at) {
  const sockaddr_in address = address_of(at);
  return ::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

bool connect_to(const Socket& socket, const Ipv4& to) {
  const sockaddr_in address = address_of(to);
  return ::connect(socket.fd(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
         errno == EINPROGRESS;
}

void set(const Socket& socket, int level, int option, int value = 1) {
  ::setsockopt(socket.fd(), level, option, &value, sizeof value);
}

void tune_tcp(const Socket& socket) {
  set(socket, IPPROTO_TCP, TCP_NODELAY);
  set(socket, SOL_SOCKET, SO_SNDBUF, 1 << 16);
  set(socket, SOL_SOCKET, SO_KEEPALIVE);
  set(socket, IPPROTO_TCP, TCP_KEEPIDLE, 10);             // s
  set(socket, IPPROTO_TCP, TCP_KEEPINTVL, 5);             // s
  set(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, 30 * 1000);  // ms
}

}  // namespace

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

LinkResult<Ipv4> resolve(const std::string& host, int port) {
  if (const auto number = parse_ipv4(host, port)) return *number;
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (error != 0 || !found)
    return link_error(LinkFault::unreachable, host,
                      fmt::format("no IPv4 address: {}", ::gai_strerror(error)));
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  ::freeaddrinfo(found);
  return Ipv4{ntohl(address.sin_addr.s_addr), port};
}

namespace {

// Shared by the thread that looks a name up and the thread that waits for the answer.
struct Lookup {
  std::mutex mutex;
  std::condition_variable answered;
  std::optional<LinkResult<Ipv4>> answer;
};

}  // namespace

LinkResult<Ipv4> resolve_unless(const std::atomic<bool>* stopped, const std::string& host, int port,
                                const Resolver& resolver) {
  if (const auto number = parse_ipv4(host, port)) return *number;
  const auto lookup = std::make_shared<Lookup>();
  try {
    std::thread thread([lookup, host, port, resolver] {
      LinkResult<Ipv4> answer = resolver(host, port);
      const std::lock_guard lock(lookup->mutex);
      lookup->answer = std::move(answer);
      lookup->answered.notify_one();
    });
    thread.detach();  // Process-wide: a lookup cannot be cancelled; this thread may outlive its caller
  } catch (const std::system_error& error) {
    return link_error(LinkFault::unreachable, host, fmt::format("no thread to look it up: {}", error.what()));
  }
  std::unique_lock lock(lookup->mutex);
  while (!lookup->answer) {
    if (stopped && *stopped) return link_error(LinkFault::stopped, host);
    lookup->answered.wait_for(lock, std::chrono::milliseconds(20));
  }
  return *lookup->answer;
}

LinkResult<Socket> listen_tcp(const Ipv4& at) {
  Socket socket = open_socket(SOCK_STREAM);
  set(socket, SOL_SOCKET, SO_REUSEADDR);
  if (!socket || !bind_to(socket, at) || ::listen(socket.fd(), 16) != 0) return failed(at);
  return socket;
}

LinkResult<Socket> bind_udp(const Ipv4& at) {
  Socket socket = open_socket(SOCK_DGRAM);
  if (!socket || !bind_to(socket, at)) return failed(at);
  return socket;
}

LinkResult<Socket> connect_udp(const Ipv4& to) {
  Socket socket = open_socket(SOCK_DGRAM);
  if (!socket || !connect_to(socket, to)) return failed(to);
  return socket;
}

LinkResult<Socket> dial_tcp(const Ipv4& to, std::uint32_t from_host) {
  Socket socket = open_socket(SOCK_STREAM);
  tune_tcp(socket);
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
  tune_tcp(socket);
  return Accepted{std::move(socket), ipv4_of(address)};
}

Ipv4 local_address(const Socket& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket.fd(), reinterpret_cast<sockaddr*>(&address), &size);
  return ipv4_of(address);
}

LinkFault send_datagram(const Socket& udp, ByteView bytes) {
  return ::send(udp.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0 ? fault_of(errno) : LinkFault::none;
}

std::optional<Datagram> receive(const Socket& udp, std::span<std::uint8_t> buffer) {
  sockaddr_in from{};
  socklen_t from_size = sizeof from;
  // Fuzzed by fuzz/vrpn_session.cpp through be_served
  const ssize_t size =
      ::recvfrom(udp.fd(), buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &from_size);
  if (size < 0) return std::nullopt;
  return Datagram{buffer.first(std::size_t(size)), ipv4_of(from)};
}

void wait_for(const Socket& first, const Socket& second, bool first_writable, std::int64_t patience_ns) {
  // poll() ignores negative descriptors.
  pollfd polled[2] = {{first.fd(), short(POLLIN | (first_writable ? POLLOUT : 0)), 0},
                      {second.fd(), POLLIN, 0}};
  const timespec patience{patience_ns / 1000000000, patience_ns % 1000000000};
  ::ppoll(polled, 2, &patience, nullptr);
}

}  // namespace intaglio::haptics::vrpn
