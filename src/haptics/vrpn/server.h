// A VRPN server that shows one simulated PHANToM.
#pragma once

#include <memory>
#include <chrono>
#include <list>

#include "haptics/device.h"
#include "haptics/vrpn/connection.h"
#include "haptics/vrpn/force.h"

namespace intaglio::haptics::vrpn {

struct PhantomOptions {
  DeviceModel model;
  Hand hand;
  GuardLimits limits;
  PlaneUnits units;
  std::vector<Waypoint> path;  // empty: a circle, for twelve hours
  double silence = 0.040;      // s, after which a request expires
};

struct PhantomState {
  Vec3 position = Vec3::Zero();  // m, as the encoders report it
  Vec3 velocity = Vec3::Zero();  // m/s, filtered
  Vec3 force = Vec3::Zero();     // N, on the hand
  bool over_limit = false;       // more than the peak force is requested
  std::optional<Vec3> contact;   // on the plane touched
  std::array<std::int32_t, 2> buttons = {};
};

// The PHANToM of `intaglio devices serve`: a simulated device in a simulated hand that moves on an inclined
// circle, two buttons, and the force requested by a client, through a guard.
//
// Requests must be renewed: the force drops to zero `silence` seconds after the last one, and the next one
// ramps in anew. tick() does not allocate. One thread.
class ServedPhantom {
 public:
  explicit ServedPhantom(const PhantomOptions& options);

  // `requested` is a ForceReport, PlaneMessage or ForceField.
  template <class Request>
  void request(const Request& requested, SteadyTime now) {
    if (!requested_.is_active()) guard_.rearm();
    requested_.set(requested);
    requested_at_ = now;
  }
  void release() { requested_.clear(); }
  bool is_held() const { return requested_.is_active(); }

  // Advances by `dt` seconds.
  void tick(double dt, SteadyTime now);
  const PhantomState& state() const { return state_; }

 private:
  PhantomOptions options_;
  SimulatedDevice device_;
  Guard guard_;
  RequestedForce requested_;
  SteadyTime requested_at_;
  PhantomState state_;
};

struct ServerOptions {
  std::string name = "Phantom0";
  std::string bind = "127.0.0.1";  // address to listen on
  int port = default_port;         // 0: any free one
  double report_rate = 1000;       // Hz, until a client sets another
  std::size_t max_clients = 16;
  PhantomOptions phantom;
  std::chrono::milliseconds cookie_patience{3000}, message_patience{5000};
  std::function<void(const std::string&)> log = [](const std::string&) {};  // one line each
};

// Shows a ServedPhantom as one sender that is tracker, buttons and force device.
//
// Accepts TCP connections and connects back on UDP request, on one port; reports to each client at its own
// rate; one client at a time controls the force. step() never blocks and is called about once a millisecond,
// by run() or by its owner; one thread. Beyond `max_clients`, connections are rejected, and the log says so.
// Listens on this machine only by default: VRPN has no authentication.
class Server {
 public:
  static LinkResult<std::unique_ptr<Server>> open(const ServerOptions& options);

  // Does everything that is due: connections, messages, ticks of the phantom (1 kHz), reports.
  void step(SteadyTime now);
  // Steps every millisecond until `stopped` is set.
  void run(const std::atomic<bool>& stopped);

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
  struct Dial {
    Socket socket;
    Ipv4 peer;
    SteadyTime since;
  };

  Server(const ServerOptions& options, Socket tcp, Socket udp, SteadyTime now);
  void add_peer(Socket socket, const Ipv4& peer, bool udp, SteadyTime now);
  bool full() const { return peers_.size() + dials_.size() >= options_.max_clients; }
  void accept_calls(SteadyTime now);
  void read_dial_requests(SteadyTime now);
  void dial(const Ipv4& to, SteadyTime now);
  void finish_dials(SteadyTime now);
  void tick(SteadyTime now);
  void broadcast_buttons();
  void report_over_limit();
  void service(Peer& peer, SteadyTime now);
  void report(Peer& peer);
  void send_buttons(Peer& peer);
  bool handle(Peer& peer, const Received& received, SteadyTime now);
  template <class Request>
  bool request(Peer& peer, const std::optional<Request>& requested, SteadyTime now);
  void remove_dead_peers();

  ServerOptions options_;
  Socket tcp_, udp_;
  int port_ = 0;
  ServedPhantom phantom_;
  std::list<Peer> peers_;
  std::list<Dial> dials_;
  Peer* holder_ = nullptr;   // the client that controls the force
  bool over_limit_ = false;  // as reported to it
  SteadyTime next_tick_, last_rejected_;
  std::array<std::int32_t, 2> buttons_ = {};
  std::int64_t dropped_for_bad_frames_ = 0, force_messages_ = 0;
};

}  // namespace intaglio::haptics::vrpn
