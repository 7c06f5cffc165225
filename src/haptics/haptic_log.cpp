#include "haptics/haptic_log.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "core/hash.h"

namespace intaglio::haptics {

namespace {

constexpr std::string_view first_line = "# intaglio haptic log 1";
constexpr std::string_view columns =
    "time_s,"
    "device_x_m,device_y_m,device_z_m,device_qw,device_qx,device_qy,device_qz,"
    "tip_x_m,tip_y_m,tip_z_m,proxy_x_m,proxy_y_m,proxy_z_m,v_x_m_s,v_y_m_s,v_z_m_s,"
    "u,v,surface_height_m,n_sx,n_sy,n_sz,touching,touching_ball,"
    "force_x_N,force_y_N,force_z_N,wanted_x_N,wanted_y_N,wanted_z_N,torque_x_N_m,torque_y_N_m,torque_z_N_m,"
    "energy_surplus_J,guard_status";
constexpr std::size_t column_count = 36;

using Row = std::array<double, column_count>;

// The order of the columns, for reading and writing: calls `with(value)` for each up to `touching`.
template <class Sample, class With>
void each_column(Sample& s, const With& with) {
  const auto vector = [&](auto& v) {
    for (int k = 0; k < 3; ++k) with(v[k]);
  };
  vector(s.device);
  with(s.orientation.w());
  with(s.orientation.x());
  with(s.orientation.y());
  with(s.orientation.z());
  vector(s.tip);
  vector(s.proxy);
  vector(s.velocity);
  with(s.uv[0]);
  with(s.uv[1]);
  with(s.surface_height);
  vector(s.n_s);
}

// The same for the columns after `touching_ball`.
template <class Sample, class With>
void each_later_column(Sample& s, const With& with) {
  for (auto* v : {&s.force, &s.wanted, &s.torque}) {
    for (int k = 0; k < 3; ++k) with((*v)[k]);
  }
  with(s.energy_surplus);
}

ServoSample sample_of(const Row& row) {
  ServoSample sample;
  std::size_t next = 1;
  const auto take = [&](double& value) { value = row[next++]; };
  each_column(sample, take);
  sample.touching = row[next++] != 0;
  sample.touching_ball = row[next++] != 0;
  each_later_column(sample, take);
  sample.guard_status = std::uint32_t(row[next]);
  return sample;
}

// Splits a text into lines and counts them.
class Lines {
 public:
  Lines(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  // Absent at the end, and for a last line without its newline.
  std::optional<std::string_view> next() {
    const std::size_t end = text_.find('\n', at_);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = text_.substr(at_, end - at_);
    start_ = at_;
    at_ = end + 1;
    ++number_;
    return line;
  }
  bool at_end() const { return at_ == text_.size(); }
  // Everything before the line returned last.
  std::string_view before() const { return text_.substr(0, start_); }
  tl::unexpected<Error> error(std::string what, std::string fix = {}) const {
    return fail(fmt::format("{}:{}", name_, number_), std::move(what), std::move(fix));
  }

 private:
  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0, start_ = 0;
  int number_ = 0;
};

template <class Number, class... Base>
bool parse(std::string_view text, Number& value, Base... base) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base...);
  return error == std::errc() && end == text.data() + text.size();
}

// The value of a line "# key value".
std::optional<std::string_view> header_value(Lines& lines, std::string_view key) {
  const auto line = lines.next();
  const std::string start = fmt::format("# {} ", key);
  if (!line || line->substr(0, start.size()) != start) return std::nullopt;
  return line->substr(start.size());
}

bool parse_row(std::string_view line, Row& row) {
  for (std::size_t k = 0; k < row.size(); ++k) {
    const std::size_t comma = line.find(',');
    if ((comma == std::string_view::npos) != (k + 1 == row.size())) return false;
    if (!parse(line.substr(0, comma), row[k])) return false;
    if (comma != std::string_view::npos) line.remove_prefix(comma + 1);
  }
  // The status is a 32-bit integer.
  return row.back() >= 0 && row.back() <= 4294967295.0;
}

std::uint64_t hash_of(std::string_view text) {
  Hash hash;
  hash.add(text);
  return hash.value();
}

}  // namespace

std::uint64_t fingerprint(const surface::Surface& surface) {
  Hash hash;
  for (int j = 0; j < surface.height(); ++j) {
    for (int i = 0; i < surface.width(); ++i) hash.add(surface.texel_z(i, j));
  }
  hash.add(surface.placement().size_u());
  hash.add(surface.placement().size_v());
  hash.add(int(surface.edge()));
  return hash.value();
}

LogEncoder::LogEncoder(double rate, std::string_view texture, std::uint64_t surface,
                       std::function<void(std::string_view)> out)
    : rate_(rate), out_(std::move(out)) {
  std::string one_line(texture);
  for (char& c : one_line) c = c == '\n' || c == '\r' ? ' ' : c;
  text_ = fmt::format("{}\n# rate {}\n# texture {}\n# surface {:016x}\n{}\n", first_line, rate, one_line,
                      surface, columns);
  emit();
}

void LogEncoder::emit() {
  hash_.add(std::string_view(text_));
  out_(text_);
  text_.clear();
}

void LogEncoder::add(const ServoSample& s) {
  const auto add = [&](double value) { fmt::format_to(std::back_inserter(text_), ",{}", value); };
  fmt::format_to(std::back_inserter(text_), "{}", double(rows_++) / rate_);
  each_column(s, add);
  add(s.touching ? 1 : 0);
  add(s.touching_ball ? 1 : 0);
  each_later_column(s, add);
  add(s.guard_status);
  text_ += '\n';
  emit();
}

void LogEncoder::finish() {
  out_(fmt::format("# end {} {:016x}\n", rows_, hash_.value()));
}

std::string encode_log(double rate, std::string_view texture, std::uint64_t surface,
                       std::span<const ServoSample> samples) {
  std::string text;
  LogEncoder encoder(rate, texture, surface, [&](std::string_view part) { text += part; });
  for (const ServoSample& sample : samples) encoder.add(sample);
  encoder.finish();
  return text;
}

Result<HapticLog> decode_log(std::string_view text, const std::string& name) {
  Lines lines(text, name);
  HapticLog log;
  if (lines.next() != first_line)
    return lines.error("not a haptic log", fmt::format("its first line is \"{}\"", first_line));
  const auto rate = header_value(lines, "rate");
  if (!rate || !parse(*rate, log.rate) || !(log.rate > 0 && log.rate <= 1e6))
    return lines.error("no servo rate", "\"# rate HERTZ\"");
  const auto texture = header_value(lines, "texture");
  if (!texture) return lines.error("no texture", "\"# texture NAME\"");
  log.texture = *texture;
  const auto surface = header_value(lines, "surface");
  if (!surface || !parse(*surface, log.surface, 16))
    return lines.error("no fingerprint of the surface", "\"# surface HEXADECIMAL\"");
  if (lines.next() != columns) return lines.error("not the columns of this version");
  while (const auto line = lines.next()) {
    if (line->substr(0, 2) == "# ") {
      const std::string end = fmt::format("# end {} {:016x}", log.samples.size(), hash_of(lines.before()));
      if (*line != end) return lines.error("checksum mismatch: the log was modified");
      if (!lines.at_end()) return lines.error("text after the end of the log");
      return log;
    }
    Row row;
    if (!parse_row(*line, row)) return lines.error(fmt::format("not {} numbers", column_count));
    log.samples.push_back(sample_of(row));
  }
  return lines.error("the log is truncated", "its last line is \"# end ROWS HASH\"");
}

}  // namespace intaglio::haptics
