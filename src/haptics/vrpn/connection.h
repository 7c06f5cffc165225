// One VRPN connection, once the TCP link is up: cookies, descriptions, messages both ways, and the rules that
// a peer must keep.
//
// A peer is dropped after three malformed frames, for a cookie that is not VRPN's, for a cookie or a message
// that takes too long, when it does not read its socket, and when it neither sends nor reads for long.
// Low-latency messages go by UDP once the peer has named its port, and only to the address of its TCP link.
// step() never blocks; one thread. The handler's argument is valid during the call only.
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
  ByteView payload;
};

enum class Channel { reliable, low_latency };

struct ConnectionOptions {
  std::vector<std::string> senders;  // our names, beginning with "VRPN Control"
  bool udp = false;                  // also listen for UDP, and tell the peer
  std::chrono::milliseconds cookie_patience{3000};
  std::chrono::milliseconds message_patience{5000};  // for the rest of a message that has begun
  std::chrono::milliseconds idle_patience{30000};    // for a byte sent or read, while some wait to be read
};

inline constexpr int bad_frame_limit = 3;

class Connection {
 public:
  // Returns whether the payload was valid; invalid ones count as malformed frames.
  using Handler = std::function<bool(const Received&)>;

  Connection(Socket tcp, const Ipv4& peer, ConnectionOptions options, SteadyTime now);

  // Reads, calls the handler, writes. Does nothing after a fault. Without a handler it stops after the
  // cookie; later messages wait for a step with one.
  void step(SteadyTime now, const Handler& handler);
  // Queues a message, which leaves with the next step(); `sender` is an index into options.senders.
  // Low-latency messages are dropped, not queued, while the peer does not keep up.
  void send(Type type, std::int32_t sender, const Bytes& payload, Channel channel,
            const Stamp& time = Stamp::now());

  LinkFault fault() const { return fault_; }
  bool is_established() const { return established_; }  // the peer has sent a valid cookie
  const Cookie& peer_cookie() const { return peer_cookie_; }
  const PeerNames& peer_names() const { return names_; }
  const Ipv4& peer() const { return peer_; }
  // The last time that the peer sent something, or that it had room for all that we sent.
  SteadyTime alive_at() const { return alive_at_; }
  int bad_frames() const { return bad_frames_ + framer_.bad_frames(); }
  bool sends_udp() const { return bool(udp_out_); }
  std::int64_t datagrams_received() const { return datagrams_received_; }
  const Socket& tcp() const { return tcp_; }
  const Socket& udp() const { return udp_in_; }
  bool wants_to_write() const { return sent_ < out_.size(); }

 private:
  void read_tcp(SteadyTime now, const Handler& handler);
  void handle_messages(SteadyTime now, const Handler& handler);
  void read_udp(SteadyTime now, const Handler& handler);
  bool check_cookie();
  void append(Bytes& out, Message message);
  void describe_ourselves();
  void handle(const Message& message, const Handler& handler, bool datagram);
  bool handle_system(const Message& message);
  void write_tcp(SteadyTime now);
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
  bool established_ = false;
  SteadyTime alive_at_;
  SteadyTime waiting_since_;  // for the cookie, or for the rest of a message
  std::int32_t sequence_ = 0;
  int bad_frames_ = 0;  // with invalid contents; the framer counts invalid lengths
  std::int64_t datagrams_received_ = 0;
  LinkFault fault_ = LinkFault::none;
};

}  // namespace intaglio::haptics::vrpn
