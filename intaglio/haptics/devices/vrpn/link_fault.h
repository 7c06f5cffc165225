// Why a link is not there, or no longer.
#pragma once

#include <string_view>

#include "intaglio/core/error.h"

namespace intaglio::haptics::vrpn {

enum class LinkFault {
  none,
  unreachable,  // no such host, or no way to it
  refused,      // the host has nobody at that port
  timed_out,    // no answer
  not_vrpn,     // somebody answers, in another language
  closed,       // the peer ended the link
  bad_frames,   // three of the peer's frames could not be believed
  too_slow,     // a message or a cookie took the peer too long
  not_reading,  // what we send piles up
  port_taken,   // another program serves that port
  stopped,      // we were asked to stop
};

std::string_view meaning(LinkFault fault);

// For people and for exit codes.
struct LinkFailure {
  LinkFault fault = LinkFault::none;
  Error error;
};

template <class T>
using Linked = tl::expected<T, LinkFailure>;

inline tl::unexpected<LinkFailure> link_failure(LinkFault fault, std::string where, std::string fix = {}) {
  return tl::unexpected<LinkFailure>(
      LinkFailure{fault, Error{std::move(where), std::string(meaning(fault)), std::move(fix)}});
}

}  // namespace intaglio::haptics::vrpn
