// The 24 bytes with which each side of a VRPN connection opens: "vrpn: ver. 07.38", two spaces, the digit of
// the log mode that it wants of the other side, NULs. Two sides understand each other when they agree up to
// the last '.'; another minor version is worth a warning only.
#pragma once

#include <array>

#include "intaglio/haptics/devices/vrpn/wire.h"

namespace intaglio::haptics::vrpn {

inline constexpr std::size_t cookie_size = 24;

enum class CookieMatch { same, other_minor_version, not_vrpn };

struct Cookie {
  CookieMatch match = CookieMatch::not_vrpn;
  int log_mode = 0;     // 0..3; we never write log files for a peer, whatever it asks
  std::string version;  // "07.38"; empty when it is no cookie
};

// Ours; we never ask a peer to log.
std::array<std::uint8_t, cookie_size> our_cookie();
// `bytes` holds cookie_size bytes.
Cookie read_cookie(View bytes);

}  // namespace intaglio::haptics::vrpn
