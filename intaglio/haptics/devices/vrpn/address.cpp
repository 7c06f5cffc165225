#include "intaglio/haptics/devices/vrpn/address.h"

#include <charconv>

#include "intaglio/haptics/devices/vrpn/names.h"

namespace intaglio::haptics::vrpn {

std::string Address::text() const {
  return fmt::format("{}@{}:{}", name, host, port);
}

static constexpr std::string_view tcp_scheme = "tcp://";

Result<Address> parse_address(std::string_view text) {
  const auto wrong = [&](const char* what) {
    return fail(std::string(text), what, "write NAME@HOST[:PORT], for example Phantom0@localhost");
  };
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos || at == 0) return wrong("no name before an '@'");
  Address address;
  address.name = text.substr(0, at);
  if (address.name.size() >= name_limit) return wrong("the name is too long");
  std::string_view host = text.substr(at + 1);
  if (host.starts_with(tcp_scheme)) {
    address.tcp_only = true;
    host.remove_prefix(tcp_scheme.size());
  }
  const std::size_t colon = host.find(':');
  if (colon != std::string_view::npos) {
    const std::string_view digits = host.substr(colon + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), address.port);
    if (error != std::errc() || end != digits.data() + digits.size() || address.port < 1 ||
        address.port > 65535)
      return wrong("the port must be a number from 1 to 65535");
    host = host.substr(0, colon);
  }
  address.host = host;
  if (address.host.empty()) return wrong("no host after the '@'");
  return address;
}

}  // namespace intaglio::haptics::vrpn
