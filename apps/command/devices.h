// What the parts of `intaglio devices` share.
//
// Exit codes beyond those of every verb (apps/command/verb.h): 3 the host cannot be reached; 4 nobody is at that port;
// 5 no answer in time; 6 it is not a VRPN server; 7 the link was lost; 8 the port to serve on is taken.
#pragma once

#include <atomic>
#include <string>

#include "command/verb.h"
#include "haptics/vrpn/socket.h"

namespace intaglio::app {

// Set by SIGINT and SIGTERM once catch_interrupts() was called.
extern std::atomic<bool> devices_interrupted;
void catch_interrupts();

// Prints the failure as one line; returns its exit code.
int report(const haptics::vrpn::LinkFailure& failure);

struct MonitorOptions {
  std::string address;
  bool tcp = false, json = false;
  double seconds = 0;  // 0: until interrupted
};
int run_monitor(const MonitorOptions& options, const Common& common);

}  // namespace intaglio::app
