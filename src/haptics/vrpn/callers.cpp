#include "haptics/vrpn/callers.h"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <map>

namespace intaglio::haptics::vrpn {

namespace {

// LinkFault::none if a caller has sent VRPN's cookie, nothing while too few bytes are there.
std::optional<LinkFault> greeting(const Socket& socket) {
  std::array<std::uint8_t, cookie_size> bytes;
  const ssize_t size = ::recv(socket.fd(), bytes.data(), bytes.size(), MSG_PEEK);
  if (size == 0) return LinkFault::closed;
  if (size < 0) {
    const bool is_open = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    return is_open ? std::nullopt : std::optional(LinkFault::closed);
  }
  if (std::size_t(size) < bytes.size()) return std::nullopt;
  return read_cookie(bytes).match == CookieMatch::not_vrpn ? LinkFault::not_vrpn : LinkFault::none;
}

}  // namespace

void Callers::add(Caller caller, const Lost& lost) {
  callers_.push_back(std::move(caller));
  if (callers_.size() <= limit) return;
  std::map<std::uint32_t, int> calls;
  for (const Caller& waiting : callers_) ++calls[waiting.peer.host];
  const auto most = std::max_element(calls.begin(), calls.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto oldest = std::find_if(callers_.begin(), callers_.end(),
                                   [&](const Caller& waiting) { return waiting.peer.host == most->first; });
  lost(*oldest, LinkFault::crowded);
  callers_.erase(oldest);
}

void Callers::step(SteadyTime now, const Greeted& greeted, const Lost& lost) {
  for (auto caller = callers_.begin(); caller != callers_.end();) {
    std::optional<LinkFault> said = greeting(caller->socket);
    if (!said && now - caller->since > patience_) said = LinkFault::too_slow;
    if (!said) {
      ++caller;
      continue;
    }
    Caller done = std::move(*caller);
    caller = callers_.erase(caller);
    if (*said == LinkFault::none) {
      greeted(std::move(done));
    } else {
      lost(done, *said);
    }
  }
}

bool Callers::contains(const Ipv4& peer) const {
  return std::any_of(callers_.begin(), callers_.end(),
                     [&](const Caller& caller) { return caller.peer == peer; });
}

}  // namespace intaglio::haptics::vrpn
