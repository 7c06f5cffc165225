// How people name a VRPN device: NAME@HOST[:PORT], or NAME@tcp://HOST[:PORT] to use TCP only.
#pragma once

#include <string>
#include <string_view>

#include "intaglio/core/error.h"
#include "intaglio/haptics/devices/vrpn/message.h"

namespace intaglio::haptics::vrpn {

struct Address {
  std::string name;  // of the sender, for example "Phantom0"
  std::string host;
  int port = default_port;
  bool tcp_only = false;

  std::string text() const;  // "Phantom0@localhost:3883"
};

Result<Address> parse_address(std::string_view text);

}  // namespace intaglio::haptics::vrpn
