#include "intaglio/haptics/devices/vrpn/link_fault.h"

namespace intaglio::haptics::vrpn {

std::string_view meaning(LinkFault fault) {
  switch (fault) {
    case LinkFault::none:
      return "linked";
    case LinkFault::unreachable:
      return "the host cannot be reached";
    case LinkFault::refused:
      return "connection refused";
    case LinkFault::timed_out:
      return "no answer";
    case LinkFault::not_vrpn:
      return "this is not a VRPN peer of version 07";
    case LinkFault::closed:
      return "the peer closed the link";
    case LinkFault::bad_frames:
      return "dropped after three bad frames";
    case LinkFault::too_slow:
      return "dropped: a message took too long to arrive";
    case LinkFault::not_reading:
      return "dropped: the peer does not read what it is sent";
    case LinkFault::port_taken:
      return "the port is taken";
    case LinkFault::stopped:
      return "stopped";
  }
  return "";
}

}  // namespace intaglio::haptics::vrpn
