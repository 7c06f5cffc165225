// One VRPN connection after somebody has dialled: cookies, descriptions, messages both ways, and the rules
// that a peer must keep.
//
// A peer is dropped when three of its frames cannot be believed, when its cookie is not VRPN's, when a cookie
// or a message takes too long, or when it does not read. UDP is used for low-latency messages once the peer
// has said where it listens, and only towards the address that the TCP link has. step() never blocks; one
// thread. What the handler gets is valid during its call only.
#pragma once

#include <chrono>
#include <functional>

#include "haptics/vrpn/message.h"
#include "haptics/vrpn/socket.h"

namespace intaglio::haptics::vrpn {

using SteadyTime = std::chrono::steady_clock::time_point;

struct Received {
  Type type = Type::ping;
  std::string_view sender;  // name
  Stamp time;
  View payload;
};

enum class Channel { reliable, low_latency };

struct ConnectionOptions {
  std::vector<std::string> senders;  // our names, beginning with "VRPN Control"
  bool udp = false;                  // listen for UDP too, and say so
  std::chrono::milliseconds cookie_patience{3000};
  std::chrono::milliseconds message_patience{5000};  // for the rest of a message that has begun
};

inline constexpr int bad_frame_limit = 3;

class Connection {
 public:
  // Whether the payload was sound; unsound ones count as bad frames.
  using Handler = std::function<bool(const Received&)>;

  Connection(Socket tcp, const Ipv4& peer, ConnectionOptions options, SteadyTime now);

  // Reads, hands over, writes. Does nothing after a fault. Without a handler it gets as far as the cookie;
  // what follows waits for a step with one.
  void step(SteadyTime now, const Handler& handler);
  // Queues a message of ours; `sender` is the place in options.senders. Leaves with the next step().
  // Low-latency messages are left out, rather than queued, while the peer does not keep up.
  void send(Type type, std::int32_t sender, const Bytes& payload, Channel channel,
            const Stamp& time = Stamp::now());

  LinkFault fault() const { return fault_; }
  bool greeted() const { return greeted_; }  // the peer's cookie came and was right
  const Cookie& peer_cookie() const { return peer_cookie_; }
  const PeerNames& peer_names() const { return names_; }
  const Ipv4& peer() const { return peer_; }
  int bad_frames() const { return bad_frames_ + framer_.bad_frames(); }
  bool sends_udp() const { return static_cast<bool>(udp_out_); }
  std::int64_t datagrams_received() const { return datagrams_received_; }
  const Socket& tcp() const { return tcp_; }
  const Socket& udp() const { return udp_in_; }
  bool wants_to_write() const { return sent_ < out_.size(); }

 private:
  void read_tcp(SteadyTime now, const Handler& handler);
  void take_messages(SteadyTime now, const Handler& handler);
  void read_udp(const Handler& handler);
  bool greet();
  void queue(const Message& message);
  void describe_ourselves();
  void take(const Message& message, const Handler& handler, bool datagram);
  bool take_system(const Message& message);
  void write_tcp();
  void write_datagram();
  void check_patience(SteadyTime now);
  void drop(LinkFault fault);

  Socket tcp_, udp_in_, udp_out_;
  Ipv4 peer_;
  ConnectionOptions options_;
  Framer framer_;
  PeerNames names_;
  Bytes out_, datagram_, scratch_;
  std::size_t sent_ = 0;  // of out_
  Cookie peer_cookie_;
  bool greeted_ = false;
  SteadyTime waiting_since_;  // for the cookie, or for the rest of a message
  std::int32_t sequence_ = 0;
  int bad_frames_ = 0;  // of contents; the framer counts the lengths
  std::int64_t datagrams_received_ = 0;
  LinkFault fault_ = LinkFault::none;
};

}  // namespace intaglio::haptics::vrpn
