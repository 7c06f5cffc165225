#include "haptics/vrpn/connection.h"

#include <sys/socket.h>

#include <cassert>
#include <cerrno>

#include "haptics/vrpn/message.h"

namespace intaglio::haptics::vrpn {

namespace {

// A step makes few reads, so that no peer keeps the others waiting.
constexpr std::size_t read_size = 16384;
constexpr int reads_per_step = 4;
// Beyond the first, reports are dropped; beyond the second, the peer is.
constexpr std::size_t report_backlog = 64000;
constexpr std::size_t backlog_limit = 4 * report_backlog;

}  // namespace

Connection::Connection(Socket tcp, const Ipv4& peer, ConnectionOptions options, SteadyTime now)
    : tcp_(std::move(tcp)),
      peer_(peer),
      options_(std::move(options)),
      scratch_(read_size),
      alive_at_(now),
      waiting_since_(now) {
  const auto cookie = our_cookie();
  out_.assign(cookie.begin(), cookie.end());
}

void Connection::step(SteadyTime now, const Handler& handler) {
  if (fault_ != LinkFault::none) return;
  handle_messages(now, handler);
  read_tcp(now, handler);
  if (udp_in_ && handler) read_udp(now, handler);
  if (bad_frames() >= bad_frame_limit) drop(LinkFault::bad_frames);
  check_patience(now);
  if (fault_ != LinkFault::none) return;
  write_datagram();
  write_tcp(now);
}

void Connection::read_tcp(SteadyTime now, const Handler& handler) {
  for (int k = 0; k < reads_per_step && fault_ == LinkFault::none && bad_frames() < bad_frame_limit; ++k) {
    // Fuzzed by fuzz/vrpn_session.cpp through Server
    const ssize_t size = ::recv(tcp_.fd(), scratch_.data(), scratch_.size(), 0);
    if (size == 0) return drop(LinkFault::closed);
    if (size < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) drop(LinkFault::closed);
      return;
    }
    alive_at_ = now;
    if (established_ && framer_.waiting() == 0) waiting_since_ = now;
    framer_.feed(ByteView(scratch_).first(std::size_t(size)));
    if (!established_ && !check_cookie()) continue;
    handle_messages(now, handler);
  }
}

void Connection::handle_messages(SteadyTime now, const Handler& handler) {
  if (!established_ || !handler) return;
  while (bad_frames() < bad_frame_limit) {
    const auto message = framer_.next();
    if (!message) return;
    waiting_since_ = now;
    handle(*message, handler, false);
  }
}

bool Connection::check_cookie() {
  const ByteView bytes = framer_.take(cookie_size);
  if (bytes.empty()) return false;
  peer_cookie_ = read_cookie(bytes);
  established_ = peer_cookie_.match != CookieMatch::not_vrpn;
  if (!established_) {
    drop(LinkFault::not_vrpn);
  } else {
    describe_ourselves();
  }
  return established_;
}

void Connection::describe_ourselves() {
  Bytes payload;
  if (options_.udp) {
    const Ipv4 local = local_address(tcp_);
    if (auto udp = bind_udp({local.host, 0})) {
      udp_in_ = std::move(*udp);
      encode_udp_host(payload, local.host_text());
      append(out_, {Stamp::now(), local_address(udp_in_).port, udp_description, 0, payload});
    }
  }
  const auto describe = [&](std::int32_t type, std::size_t id, std::string_view name) {
    payload.clear();
    encode_name(payload, name);
    append(out_, {Stamp::now(), std::int32_t(id), type, 0, payload});
  };
  for (std::size_t id = 0; id < options_.senders.size(); ++id)
    describe(sender_description, id, options_.senders[id]);
  for (std::size_t id = 0; id < type_names.size(); ++id) describe(type_description, id, type_names[id]);
}

void Connection::append(Bytes& out, Message message) {
  message.sequence = sequence_++;
  append_message(out, message);
}

void Connection::send(Type type, std::int32_t sender, const Bytes& payload, Channel channel,
                      const Stamp& time) {
  if (!established_ || fault_ != LinkFault::none) return;
  const Message message{time, sender, std::int32_t(type), 0, payload};
  if (channel == Channel::reliable || !udp_out_) {
    const std::size_t backlog = out_.size() - sent_;
    if (channel == Channel::low_latency && backlog > report_backlog) return;
    append(out_, message);
    if (backlog > backlog_limit) drop(LinkFault::not_reading);
    return;
  }
  if (datagram_.size() + padded(header_size + payload.size()) > datagram_limit) write_datagram();
  append(datagram_, message);
}

void Connection::handle(const Message& message, const Handler& handler, bool datagram) {
  if (message.type < 0) {
    // Ids are defined over TCP only.
    if (!datagram && !handle_system(message)) ++bad_frames_;
    return;
  }
  const auto type = names_.type(message.type);
  const std::string_view sender = names_.sender(message.sender);
  if (!type || sender.empty()) return;
  if (!handler({*type, sender, message.time, message.payload})) ++bad_frames_;
}

bool Connection::handle_system(const Message& message) {
  switch (message.type) {
    case sender_description: {
      const auto name = decode_name(message.payload);
      return name && names_.learn_sender(message.sender, *name);
    }
    case type_description: {
      const auto name = decode_name(message.payload);
      return name && names_.learn_type(message.sender, *name);
    }
    case udp_description: {
      const auto host = decode_udp_host(message.payload);
      if (!host || !is_valid_port(message.sender)) return false;
      // Never send UDP to a host named by someone else; TCP will do.
      const auto to = parse_ipv4(*host, message.sender);
      if (!options_.udp || !to || to->host != peer_.host) return true;
      if (auto udp = connect_udp(*to)) udp_out_ = std::move(*udp);
      return true;
    }
    case log_description:
      return is_valid_log_description(message.payload);
    case disconnect_message:
      return true;
    default:
      return false;
  }
}

void Connection::read_udp(SteadyTime now, const Handler& handler) {
  for (int k = 0; k < 8 * reads_per_step; ++k) {
    const auto datagram = receive(udp_in_, scratch_);
    if (!datagram) return;
    if (datagram->from.host != peer_.host) continue;
    ++datagrams_received_;
    alive_at_ = now;
    ByteView rest = datagram->bytes;
    while (!rest.empty()) {
      const ParsedMessage parsed = parse_message(rest);
      if (parsed.frame != Frame::complete) {
        ++bad_frames_;
        break;
      }
      handle(parsed.message, handler, true);
      rest = rest.subspan(parsed.size);
    }
  }
}

void Connection::write_datagram() {
  if (datagram_.empty()) return;
  // Port closed: fall back to TCP.
  if (send_datagram(udp_out_, datagram_) == LinkFault::refused) udp_out_ = Socket();
  datagram_.clear();
}

void Connection::write_tcp(SteadyTime now) {
  while (sent_ < out_.size()) {
    const ssize_t size = ::send(tcp_.fd(), out_.data() + sent_, out_.size() - sent_, MSG_NOSIGNAL);
    if (size < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) drop(LinkFault::closed);
      break;
    }
    sent_ += std::size_t(size);
    alive_at_ = now;
  }
  if (sent_ == out_.size()) alive_at_ = now;
  if (now - alive_at_ > options_.idle_patience) drop(LinkFault::idle);
  if (sent_ == out_.size() || sent_ > report_backlog) {
    out_.erase(out_.begin(), out_.begin() + std::ptrdiff_t(sent_));
    sent_ = 0;
  }
}

void Connection::check_patience(SteadyTime now) {
  if (fault_ != LinkFault::none) return;
  const auto waited = now - waiting_since_;
  if (!established_ && waited > options_.cookie_patience) drop(LinkFault::too_slow);
  if (established_ && framer_.waiting() > 0 && waited > options_.message_patience) drop(LinkFault::too_slow);
}

void Connection::drop(LinkFault fault) {
  if (fault_ != LinkFault::none) return;
  fault_ = fault;
  // The owner destroys the connection, and with it the socket, later; the peer learns of it now.
  ::shutdown(tcp_.fd(), SHUT_RDWR);
}

}  // namespace intaglio::haptics::vrpn
