#include "intaglio/haptics/devices/vrpn/cookie.h"

#include <algorithm>
#include <cctype>

namespace intaglio::haptics::vrpn {

static constexpr std::string_view magic = "vrpn: ver. 07.38";
static constexpr std::size_t log_mode_at = magic.size() + 2;

std::array<std::uint8_t, cookie_size> our_cookie() {
  std::array<std::uint8_t, cookie_size> cookie{};
  std::copy(magic.begin(), magic.end(), cookie.begin());
  std::fill(cookie.begin() + magic.size(), cookie.begin() + log_mode_at, ' ');
  cookie[log_mode_at] = '0';
  return cookie;
}

Cookie read_cookie(View bytes) {
  if (bytes.size() != cookie_size) return {};
  const std::string_view text = text_of(bytes);
  const std::string_view major = magic.substr(0, magic.rfind('.') + 1);
  const char log_mode = text[log_mode_at];
  if (!text.starts_with(major) || log_mode < '0' || log_mode > '3') return {};
  Cookie cookie{CookieMatch::same, log_mode - '0', std::string(text.substr(11, 5))};
  for (char& c : cookie.version)
    if (!std::isprint(static_cast<unsigned char>(c))) c = '?';
  if (!text.starts_with(magic)) cookie.match = CookieMatch::other_minor_version;
  return cookie;
}

}  // namespace intaglio::haptics::vrpn
