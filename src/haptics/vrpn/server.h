// A VRPN server that shows one simulated PHANToM.
#pragma once

#include <chrono>
#include <list>
#include <memory>

#include "haptics/vrpn/callers.h"
#include "haptics/vrpn/connection.h"
#include "haptics/vrpn/paced_log.h"
#include "haptics/vrpn/served_phantom.h"

namespace intaglio::haptics::vrpn {

struct ServerOptions {
  std::string name = "Phantom0";
  std::string bind = "127.0.0.1";  // address to listen on
  int port = default_port;         // 0: any free one
  double report_rate = 1000;       // Hz, until a client sets another
  std::size_t max_clients = 24, max_clients_per_host = 16;
  PhantomOptions phantom;
  std::chrono::milliseconds cookie_patience{3000}, message_patience{5000}, idle_patience{30000};
  std::function<void(const std::string&)> log = [](const std::string&) {};  // one line each; see PacedLog
};

// Shows a ServedPhantom as one sender that is tracker, buttons and force device.
//
// Accepts TCP connections and connects back on UDP request, on one port; reports to each client at its own
// rate; one client at a time controls the force. step() never blocks and is called about once a millisecond,
// by run() or by its owner; one thread. Listens on this machine only by default: VRPN has no authentication.
//
// Silent connections cannot shut other clients out. A connection becomes a client when it greets (callers.h),
// and no host may take every place. A client counts as served once it has introduced itself and while it
// sends, or reads what it is sent; a served client is never dropped for another. When all places are taken a
// newcomer replaces a client that is not served, or is rejected if there is none. A client that neither sends
// nor reads for `idle_patience` is dropped in any case.
class Server {
 public:
  static LinkResult<std::unique_ptr<Server>> open(const ServerOptions& options);

  // Does everything that is due: connections, messages, ticks of the phantom (1 kHz), reports.
  void step(SteadyTime now);
  // Steps every millisecond until `stopped` is set.
  void run(const std::atomic<bool>& stopped);

  // Takes a connection that has been accepted; step() does so for those to its port.
  void take(Accepted call, SteadyTime now);

  int port() const { return port_; }
  const PhantomState& phantom() const { return phantom_.state(); }
  std::size_t clients() const { return peers_.size(); }
  std::int64_t dropped_for_bad_frames() const { return dropped_for_bad_frames_; }
  std::int64_t force_messages() const { return force_messages_; }

 private:
  struct Peer {
    Connection connection;
    std::string name;  // address, for the log
    SteadyTime next_report;
    std::chrono::nanoseconds report_period;
    bool welcomed = false, was_told_busy = false;
  };
  Server(const ServerOptions& options, Socket tcp, Socket udp, SteadyTime now);
  void accept_calls(SteadyTime now);
  void read_dial_requests(SteadyTime now);
  void dial(const Ipv4& to, SteadyTime now);
  void call(Caller caller, SteadyTime now);
  Callers::Lost say_lost(SteadyTime now);
  void admit(Caller caller, SteadyTime now);
  bool make_room(const Ipv4& newcomer, SteadyTime now);
  bool is_served(const Peer& peer, SteadyTime now) const;
  void tick(SteadyTime now);
  void broadcast_buttons();
  void report_over_limit();
  void service(Peer& peer, SteadyTime now);
  void report(Peer& peer);
  void send_buttons(Peer& peer);
  bool handle(Peer& peer, const Received& received, SteadyTime now);
  template <class Request>
  bool request(Peer& peer, const std::optional<Request>& requested, SteadyTime now);
  void remove(std::list<Peer>::iterator peer, LinkFault why, SteadyTime now);
  void remove_dead_peers(SteadyTime now);

  ServerOptions options_;
  Socket tcp_, udp_;
  int port_ = 0;
  ServedPhantom phantom_;
  PacedLog log_, door_;  // of clients; of those who did not become one
  Callers callers_;
  std::list<Peer> peers_;
  Peer* holder_ = nullptr;   // the client that controls the force
  bool over_limit_ = false;  // as reported to it
  SteadyTime next_tick_;
  std::array<std::int32_t, 2> buttons_ = {};
  std::int64_t dropped_for_bad_frames_ = 0, force_messages_ = 0;
};

}  // namespace intaglio::haptics::vrpn
