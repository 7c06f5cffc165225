#include "haptics/vrpn/connection.h"

#include <sys/socket.h>

#include <cassert>
#include <cerrno>

#include "haptics/vrpn/message.h"

namespace intaglio::haptics::vrpn {

// One read; a step makes a few, so that no peer keeps the others waiting.
static constexpr std::size_t read_size = 16384;
static constexpr int reads_a_step = 4;
// Reports are left out beyond the first, the peer is dropped beyond the second.
static constexpr std::size_t report_backlog = 64000;
static constexpr std::size_t backlog_limit = 4 * report_backlog;

Connection::Connection(Socket tcp, const Ipv4& peer, ConnectionOptions options, SteadyTime now)
    : tcp_(std::move(tcp)),
      peer_(peer),
      options_(std::move(options)),
      scratch_(read_size),
      waiting_since_(now) {
  const auto cookie = our_cookie();
  out_.assign(cookie.begin(), cookie.end());
}

void Connection::step(SteadyTime now, const Handler& handler) {
  if (fault_ != LinkFault::none) return;
  take_messages(now, handler);
  read_tcp(now, handler);
  if (udp_in_ && handler) read_udp(handler);
  if (bad_frames() >= bad_frame_limit) drop(LinkFault::bad_frames);
  check_patience(now);
  if (fault_ != LinkFault::none) return;
  write_datagram();
  write_tcp();
}

void Connection::read_tcp(SteadyTime now, const Handler& handler) {
  for (int k = 0; k < reads_a_step && fault_ == LinkFault::none && bad_frames() < bad_frame_limit; ++k) {
    const ssize_t size = ::recv(tcp_.fd(), scratch_.data(), scratch_.size(), 0);
    if (size == 0) return drop(LinkFault::closed);
    if (size < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) drop(LinkFault::closed);
      return;
    }
    if (greeted_ && framer_.waiting() == 0) waiting_since_ = now;
    framer_.feed(View(scratch_).first(static_cast<std::size_t>(size)));
    if (!greeted_ && !greet()) continue;
    take_messages(now, handler);
  }
}

void Connection::take_messages(SteadyTime now, const Handler& handler) {
  if (!greeted_ || !handler) return;
  while (bad_frames() < bad_frame_limit) {
    const auto message = framer_.next();
    if (!message) return;
    waiting_since_ = now;
    take(*message, handler, false);
  }
}

bool Connection::greet() {
  const View bytes = framer_.take(cookie_size);
  if (bytes.empty()) return false;
  peer_cookie_ = read_cookie(bytes);
  greeted_ = peer_cookie_.match != CookieMatch::not_vrpn;
  if (!greeted_) {
    drop(LinkFault::not_vrpn);
  } else {
    describe_ourselves();
  }
  return greeted_;
}

void Connection::describe_ourselves() {
  Bytes payload;
  if (options_.udp) {
    const Ipv4 local = local_address(tcp_);
    if (auto udp = bind_udp({local.host, 0})) {
      udp_in_ = std::move(*udp);
      encode_udp_host(payload, local.host_text());
      queue({Stamp::now(), local_address(udp_in_).port, udp_description, 0, payload});
    }
  }
  const auto describe = [&](std::int32_t type, std::size_t id, std::string_view name) {
    payload.clear();
    encode_name(payload, name);
    queue({Stamp::now(), static_cast<std::int32_t>(id), type, 0, payload});
  };
  for (std::size_t id = 0; id < options_.senders.size(); ++id)
    describe(sender_description, id, options_.senders[id]);
  for (std::size_t id = 0; id < type_names.size(); ++id) describe(type_description, id, type_names[id]);
}

void Connection::queue(const Message& message) {
  Message numbered = message;
  numbered.sequence = sequence_++;
  append_message(out_, numbered);
}

void Connection::send(Type type, std::int32_t sender, const Bytes& payload, Channel channel,
                      const Stamp& time) {
  if (!greeted_ || fault_ != LinkFault::none) return;
  const Message message{time, sender, static_cast<std::int32_t>(type), 0, payload};
  if (channel == Channel::reliable || !udp_out_) {
    const std::size_t backlog = out_.size() - sent_;
    if (channel == Channel::low_latency && backlog > report_backlog) return;
    queue(message);
    if (backlog > backlog_limit) drop(LinkFault::not_reading);
    return;
  }
  const std::size_t size = (header_size + payload.size() + 7) / 8 * 8;
  if (datagram_.size() + size > datagram_limit) write_datagram();
  Message numbered = message;
  numbered.sequence = sequence_++;
  append_message(datagram_, numbered);
}

void Connection::take(const Message& message, const Handler& handler, bool datagram) {
  if (message.type < 0) {
    // What a number means comes by TCP only.
    if (!datagram && !take_system(message)) ++bad_frames_;
    return;
  }
  const auto type = names_.type(message.type);
  const std::string_view sender = names_.sender(message.sender);
  if (!type || sender.empty()) return;
  if (!handler({*type, sender, message.time, message.payload})) ++bad_frames_;
}

bool Connection::take_system(const Message& message) {
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
      if (!host || !sound_port(message.sender)) return false;
      // Only to the peer itself: nobody is to be flooded at a third party's word. Otherwise TCP will do.
      const auto to = parse_ipv4(*host, message.sender);
      if (!options_.udp || !to || to->host != peer_.host) return true;
      if (auto udp = connect_udp(*to)) udp_out_ = std::move(*udp);
      return true;
    }
    case log_description:
      return sound_log_description(message.payload);
    case disconnect_message:
      return true;
    default:
      return false;
  }
}

void Connection::read_udp(const Handler& handler) {
  for (int k = 0; k < 8 * reads_a_step; ++k) {
    const auto datagram = receive(udp_in_, scratch_);
    if (!datagram) return;
    if (datagram->from.host != peer_.host) continue;
    ++datagrams_received_;
    View rest = datagram->bytes;
    while (!rest.empty()) {
      const Taken taken = take_message(rest);
      if (taken.frame != Frame::whole) {
        ++bad_frames_;
        break;
      }
      take(taken.message, handler, true);
      rest = rest.subspan(taken.size);
    }
  }
}

void Connection::write_datagram() {
  if (datagram_.empty()) return;
  // The peer's port is closed: what comes goes by TCP.
  if (send_datagram(udp_out_, datagram_) == LinkFault::refused) udp_out_ = Socket();
  datagram_.clear();
}

void Connection::write_tcp() {
  while (sent_ < out_.size()) {
    const ssize_t size = ::send(tcp_.fd(), out_.data() + sent_, out_.size() - sent_, MSG_NOSIGNAL);
    if (size < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) drop(LinkFault::closed);
      break;
    }
    sent_ += static_cast<std::size_t>(size);
  }
  if (sent_ == out_.size() || sent_ > report_backlog) {
    out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(sent_));
    sent_ = 0;
  }
}

void Connection::check_patience(SteadyTime now) {
  if (fault_ != LinkFault::none) return;
  const auto waited = now - waiting_since_;
  if (!greeted_ && waited > options_.cookie_patience) drop(LinkFault::too_slow);
  if (greeted_ && framer_.waiting() > 0 && waited > options_.message_patience) drop(LinkFault::too_slow);
}

void Connection::drop(LinkFault fault) {
  if (fault_ != LinkFault::none) return;
  fault_ = fault;
  // The socket goes with the connection object, which its owner lets go of; the peer is told now.
  ::shutdown(tcp_.fd(), SHUT_RDWR);
}

}  // namespace intaglio::haptics::vrpn
