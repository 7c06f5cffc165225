// A haptic device at the other end of a VRPN link: its tracker, buttons and force device share one name.
//
//   auto pen = intaglio::open_vrpn("Phantom0@localhost");      // then a ServoLoop, haptics.h
//
// The device has a thread of its own, which dials, pings, redials a second after a loss, and talks to the
// socket. A link that is lost counts as silence, so that the guard goes to zero; when ticks stop, the far
// device is told to let go.
#pragma once

#include <string>

#include "intaglio/error.h"
#include "intaglio/haptics.h"

namespace intaglio {

// How the driver at the far end takes a force.
enum class VrpnForce {
  field,  // a force field about the tip: PHANToM and Falcon drivers
  plane,  // the plane that gives this force and holds between writes: the paper's way, for slow links
  force,  // the force itself: Intaglio's own server
};

struct VrpnOptions {
  VrpnForce force = VrpnForce::field;
  double plane_stiffness = 800, plane_damping = 1;    // N/m and N s/m, of VrpnForce::plane
  double stiffness_unit = 1000, damping_unit = 1000;  // N/m and N s/m, of one unit of the far driver
  int sensor = 0;
  double wait = 3;         // s, for the device to answer
  double silence = 0.040;  // s without a word, then the link counts as lost
};

// `address` as VRPN writes it: NAME@HOST, NAME@HOST:PORT, NAME@tcp://HOST:PORT. Errors: an address that
// cannot be read, no answer within `wait`, and why.
Result<Device> open_vrpn(const std::string& address, const VrpnOptions& options = {});

}  // namespace intaglio
