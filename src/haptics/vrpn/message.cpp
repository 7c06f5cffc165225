#include "haptics/vrpn/message.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <chrono>

namespace intaglio::haptics::vrpn {

Stamp Stamp::now() {
  const auto since = std::chrono::duration_cast<std::chrono::microseconds>(
                         std::chrono::system_clock::now().time_since_epoch())
                         .count();
  return {std::int32_t(since / 1000000), std::int32_t(since % 1000000)};
}

ParsedMessage parse_message(View bytes) {
  if (bytes.size() < header_size) return {};
  Reader header(bytes.first(header_size));
  const std::int32_t length = header.i32();
  // Checked before any arithmetic on it.
  if (length < std::int32_t(header_size) || length > std::int32_t(message_limit))
    return {Frame::bad, header_size, {}};
  const auto size = std::size_t(length);
  if (bytes.size() < padded(size)) return {};
  ParsedMessage parsed{Frame::complete, padded(size), {}};
  parsed.message.time.seconds = header.i32();
  parsed.message.time.microseconds = header.i32();
  parsed.message.sender = header.i32();
  parsed.message.type = header.i32();
  parsed.message.sequence = header.i32();
  parsed.message.payload = bytes.subspan(header_size, size - header_size);
  return parsed;
}

void append_message(Bytes& out, const Message& message) {
  const std::size_t size = header_size + message.payload.size();
  assert(size <= message_limit);
  const std::size_t end = out.size() + padded(size);
  put(out, std::int32_t(size));
  put(out, message.time.seconds);
  put(out, message.time.microseconds);
  put(out, message.sender);
  put(out, message.type);
  put(out, message.sequence);
  out.insert(out.end(), message.payload.begin(), message.payload.end());
  out.resize(end);
}

void Framer::feed(View bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + std::ptrdiff_t(used_));
  used_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

std::optional<Message> Framer::next() {
  for (;;) {
    const ParsedMessage parsed = parse_message(rest());
    if (parsed.frame == Frame::partial) return std::nullopt;
    used_ += parsed.size;
    if (parsed.frame == Frame::complete) return parsed.message;
    ++bad_frames_;
  }
}

View Framer::take(std::size_t size) {
  if (waiting() < size) return {};
  const View bytes = rest().first(size);
  used_ += size;
  return bytes;
}

namespace {

constexpr std::string_view magic = "vrpn: ver. 07.38";
constexpr std::size_t log_mode_at = magic.size() + 2;

}  // namespace

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
    if (!is_printable(c)) c = '?';
  if (!text.starts_with(magic)) cookie.match = CookieMatch::other_minor_version;
  return cookie;
}

std::optional<Type> find_type(std::string_view name) {
  const auto found = std::find(type_names.begin(), type_names.end(), name);
  if (found == type_names.end()) return std::nullopt;
  return static_cast<Type>(found - type_names.begin());
}

namespace {

// The entry of `id` in a table, which grows as needed; null for an id out of range.
template <class Table>
typename Table::value_type* slot_for(Table& table, std::int32_t id) {
  if (id < 0 || id >= id_limit) return nullptr;
  const auto at = std::size_t(id);
  if (at >= table.size()) table.resize(at + 1);
  return &table[at];
}

}  // namespace

bool PeerNames::learn_sender(std::int32_t id, std::string_view name) {
  std::string* const known = slot_for(senders_, id);
  if (known) *known = name;
  return known != nullptr;
}

bool PeerNames::learn_type(std::int32_t id, std::string_view name) {
  std::optional<Type>* const known = slot_for(types_, id);
  if (known) *known = find_type(name);
  return known != nullptr;
}

std::string_view PeerNames::sender(std::int32_t id) const {
  return id >= 0 && std::size_t(id) < senders_.size() ? senders_[std::size_t(id)] : std::string_view();
}

std::optional<Type> PeerNames::type(std::int32_t id) const {
  return id >= 0 && std::size_t(id) < types_.size() ? types_[std::size_t(id)] : std::nullopt;
}

std::vector<std::string> PeerNames::senders() const {
  std::vector<std::string> named;
  std::copy_if(senders_.begin(), senders_.end(), std::back_inserter(named),
               [](const std::string& name) { return !name.empty(); });
  return named;
}

bool PeerNames::has_named(Type type) const {
  return std::find(types_.begin(), types_.end(), std::optional(type)) != types_.end();
}

namespace {

bool in_host(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.';
}
bool is_valid_host(std::string_view host) {
  return !host.empty() && host.size() < name_limit && std::all_of(host.begin(), host.end(), in_host);
}

}  // namespace

std::optional<std::string_view> decode_name(View payload) {
  Reader reader(payload);
  const std::int32_t length = reader.i32();
  if (length < 2 || length > std::int32_t(name_limit)) return std::nullopt;
  const std::string_view text = text_of(reader.raw(std::size_t(length)));
  if (!reader.at_end() || text.back() != '\0') return std::nullopt;
  const std::string_view name = text.substr(0, text.size() - 1);
  return std::all_of(name.begin(), name.end(), is_printable) ? std::optional(name) : std::nullopt;
}

void encode_name(Bytes& out, std::string_view name) {
  put(out, std::int32_t(name.size() + 1));
  put(out, name);
  out.push_back(0);
}

std::optional<std::string> decode_udp_host(View payload) {
  const std::string_view text = text_of(payload);
  if (text.empty() || text.back() != '\0' || !is_valid_host(text.substr(0, text.size() - 1)))
    return std::nullopt;
  return std::string(text.substr(0, text.size() - 1));
}

void encode_udp_host(Bytes& out, std::string_view host) {
  put(out, host);
  out.push_back(0);
}

bool is_valid_log_description(View payload) {
  Reader reader(payload);
  const std::int64_t in = reader.i32(), out = reader.i32();
  const auto limit = std::int64_t(message_limit);
  if (!reader.ok() || in < 0 || out < 0 || in > limit || out > limit) return false;
  // It is unspecified whether a length counts its NUL.
  const auto left = std::int64_t(reader.left());
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
  if (!is_valid_host(host) || !is_valid_port(port)) return std::nullopt;
  return DialRequest{std::string(host), port};
}

void encode_dial_request(Bytes& out, const DialRequest& request) {
  put(out, std::string_view(request.host + " " + std::to_string(request.port)));
  out.push_back(0);
}

}  // namespace intaglio::haptics::vrpn
