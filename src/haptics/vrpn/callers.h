// Sockets that have called a server, or that it has dialled, until they greet it with VRPN's cookie.
//
// A caller costs a socket and nothing more: its bytes stay in the kernel. One that does not greet in time is
// hung up. A caller without room takes the place of the oldest one of the host that has the most: a real
// client greets at once, so neither a crowd of silent sockets nor one host can keep it out. step() never
// blocks; one thread.
#pragma once

#include <chrono>
#include <functional>
#include <list>

#include "haptics/vrpn/connection.h"

namespace intaglio::haptics::vrpn {

struct Caller {
  Socket socket;
  Ipv4 peer;
  bool udp = false;  // it asked by UDP to be dialled
  SteadyTime since;  // when it called or was dialled
};

class Callers {
 public:
  static constexpr std::size_t limit = 64;

  using Greeted = std::function<void(Caller)>;
  // `greeted` receives callers that have sent a cookie, which is still to be read; `lost` those that were
  // hung up, with the reason: LinkFault::crowded for those that made room.
  using Lost = std::function<void(const Caller&, LinkFault)>;

  explicit Callers(std::chrono::milliseconds patience) : patience_(patience) {}

  void add(Caller caller, const Lost& lost);
  void step(SteadyTime now, const Greeted& greeted, const Lost& lost);
  bool contains(const Ipv4& peer) const;
  std::size_t size() const { return callers_.size(); }

 private:
  std::chrono::milliseconds patience_;
  std::list<Caller> callers_;  // the oldest first
};

}  // namespace intaglio::haptics::vrpn
