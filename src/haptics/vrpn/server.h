// The PHANToM that `intaglio devices serve` shows: a simulated device in a simulated hand that goes round and
// down and up again, two buttons, and the force that a client asks for, through a guard.
//
// Whoever asks must go on asking: `silence` seconds after the last word the force is zero, and the next one
// ramps in anew. tick() allocates nothing. One thread.
#pragma once

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
  std::vector<Waypoint> path;  // empty: round and round for twelve hours
  double silence = 0.040;      // s
};

struct PhantomState {
  Vec3 position = Vec3::Zero();  // m, as the encoders report it
  Vec3 velocity = Vec3::Zero();  // m/s, filtered
  Vec3 force = Vec3::Zero();     // N, on the hand
  bool too_much = false;         // more is asked for than the device can
  std::optional<Vec3> contact;   // on the plane touched
  std::array<std::int32_t, 2> buttons = {};
};

class ServedPhantom {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit ServedPhantom(const PhantomOptions& options);

  // A message of a client: ForceReport, PlaneMessage or ForceField.
  template <class Asked>
  void ask(const Asked& asked, Time now) {
    if (!asked_.any()) guard_.rearm();
    asked_.set(asked);
    asked_at_ = now;
  }
  // The client is gone.
  void release() { asked_.clear(); }
  bool held() const { return asked_.any(); }

  // Lets `dt` seconds pass.
  void tick(double dt, Time now);
  const PhantomState& state() const { return state_; }

 private:
  PhantomOptions options_;
  SimulatedDevice device_;
  Guard guard_;
  AskedForce asked_;
  Time asked_at_;
  PhantomState state_;
};

// A VRPN server that shows one simulated PHANToM: a sender that is tracker, buttons and force device.
//
// Takes calls by TCP and dials back by UDP request, on one port; reports to each client at its own rate; lets
// one client at a time hold the force. step() never blocks and is called about once a millisecond, by run()
// or by its owner; one thread. At most `max_clients` at once, the rest are turned away and the log says so.
// Binds to this machine alone unless told otherwise: VRPN knows no passwords.

struct ServerOptions {
  std::string name = "Phantom0";
  std::string bind = "127.0.0.1";
  int port = default_port;    // 0: any free one
  double report_rate = 1000;  // Hz, until a client asks for another
  std::size_t max_clients = 16;
  PhantomOptions phantom;
  std::chrono::milliseconds cookie_patience{3000}, message_patience{5000};
  std::function<void(const std::string&)> log = [](const std::string&) {};  // one line each
};

class Server {
 public:
  static Linked<std::unique_ptr<Server>> open(const ServerOptions& options);

  // What is due: calls, messages, ticks of the phantom (1 kHz), reports.
  void step(SteadyTime now);
  // Steps every millisecond until `stopped`.
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
    bool welcomed = false, told_busy = false;
  };
  struct Dial {
    Socket socket;
    Ipv4 peer;
    SteadyTime since;
  };

  Server(const ServerOptions& options, Socket tcp, Socket udp, SteadyTime now);
  void admit(Socket socket, const Ipv4& peer, bool udp, SteadyTime now);
  bool full() const { return peers_.size() + dials_.size() >= options_.max_clients; }
  void take_calls(SteadyTime now);
  void take_requests(SteadyTime now);
  void dial(const Ipv4& to, SteadyTime now);
  void finish_dials(SteadyTime now);
  void tick(SteadyTime now);
  void tell_buttons();
  void tell_too_much();
  void talk(Peer& peer, SteadyTime now);
  void report(Peer& peer);
  void send_buttons(Peer& peer);
  bool hear(Peer& peer, const Received& received, SteadyTime now);
  template <class Asked>
  bool ask(Peer& peer, const std::optional<Asked>& asked, SteadyTime now);
  void bury();

  ServerOptions options_;
  Socket tcp_, udp_;
  int port_ = 0;
  ServedPhantom phantom_;
  std::list<Peer> peers_;
  std::list<Dial> dials_;
  Peer* holder_ = nullptr;  // of the force
  bool too_much_ = false;   // and has been told so
  SteadyTime next_tick_, last_turned_away_;
  std::array<std::int32_t, 2> buttons_ = {};
  std::int64_t dropped_for_bad_frames_ = 0, force_messages_ = 0;
};

}  // namespace intaglio::haptics::vrpn
