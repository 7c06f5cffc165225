#include "intaglio/haptics/devices/vrpn/descriptions.h"

#include <algorithm>
#include <charconv>

#include "intaglio/haptics/devices/vrpn/names.h"

namespace intaglio::haptics::vrpn {

// ASCII whatever the locale.
static bool printable(char c) {
  return c >= ' ' && c <= '~';
}
static bool in_host(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.';
}
static bool sound_host(std::string_view host) {
  return !host.empty() && host.size() < name_limit && std::all_of(host.begin(), host.end(), in_host);
}

std::optional<std::string_view> decode_name(View payload) {
  Reader reader(payload);
  const std::int32_t length = reader.i32();
  if (length < 2 || length > static_cast<std::int32_t>(name_limit)) return std::nullopt;
  const std::string_view text = text_of(reader.raw(static_cast<std::size_t>(length)));
  if (!reader.done() || text.back() != '\0') return std::nullopt;
  const std::string_view name = text.substr(0, text.size() - 1);
  return std::all_of(name.begin(), name.end(), printable) ? std::optional(name) : std::nullopt;
}

void encode_name(Bytes& out, std::string_view name) {
  put(out, static_cast<std::int32_t>(name.size() + 1));
  put(out, name);
  out.push_back(0);
}

std::optional<std::string> decode_udp_host(View payload) {
  const std::string_view text = text_of(payload);
  if (text.empty() || text.back() != '\0' || !sound_host(text.substr(0, text.size() - 1)))
    return std::nullopt;
  return std::string(text.substr(0, text.size() - 1));
}

void encode_udp_host(Bytes& out, std::string_view host) {
  put(out, host);
  out.push_back(0);
}

bool sound_log_description(View payload) {
  Reader reader(payload);
  const std::int64_t in = reader.i32(), out = reader.i32();
  const auto limit = static_cast<std::int64_t>(message_limit);
  if (!reader.ok() || in < 0 || out < 0 || in > limit || out > limit) return false;
  // Whether a length counts its NUL is not specified.
  const auto left = static_cast<std::int64_t>(reader.left());
  return left >= in + out && left <= in + out + 2;
}

std::optional<DialRequest> decode_dial_request(View datagram) {
  std::string_view text = text_of(datagram);
  if (text.empty() || text.back() != '\0') return std::nullopt;
  text.remove_suffix(1);
  const std::size_t space = text.find(' ');
  if (space == std::string_view::npos) return std::nullopt;
  const std::string_view host = text.substr(0, space), digits = text.substr(space + 1);
  int port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  if (!sound_host(host) || !sound_port(port)) return std::nullopt;
  return DialRequest{std::string(host), port};
}

void encode_dial_request(Bytes& out, const DialRequest& request) {
  put(out, std::string_view(request.host + " " + std::to_string(request.port)));
  out.push_back(0);
}

}  // namespace intaglio::haptics::vrpn
