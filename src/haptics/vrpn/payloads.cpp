#include "haptics/vrpn/payloads.h"

#include <algorithm>
#include <cmath>

namespace intaglio::haptics::vrpn {

std::optional<WireQuat> read_quat(Reader& reader) {
  WireQuat quat;
  for (double& q : quat) q = reader.f64();
  if (!std::all_of(quat.begin(), quat.end(), [](double q) { return std::isfinite(q); })) return std::nullopt;
  return quat;
}

void put_quat(Bytes& out, const WireQuat& quat) {
  for (const double q : quat) put(out, q);
}

namespace {

// An int32 sensor, then 4 bytes of padding.
bool read_sensor(Reader& reader, std::int32_t& sensor) {
  sensor = reader.i32();
  reader.i32();
  return reader.ok() && sensor >= 0 && sensor < sensor_limit;
}

// Running peers fill the padding with the sensor again.
void put_sensor(Bytes& out, std::int32_t sensor) {
  put(out, sensor);
  put(out, sensor);
}

}  // namespace

std::optional<PosQuat> decode_pos_quat(View payload) {
  Reader reader(payload);
  PosQuat pose;
  if (!read_sensor(reader, pose.sensor)) return std::nullopt;
  pose.position = reader.vec3();
  const auto quat = read_quat(reader);
  if (!reader.at_end() || !pose.position.allFinite() || !quat) return std::nullopt;
  pose.quat = *quat;
  return pose;
}

std::optional<Motion> decode_motion(View payload) {
  Reader reader(payload);
  Motion motion;
  if (!read_sensor(reader, motion.sensor)) return std::nullopt;
  motion.rate = reader.vec3();
  const auto quat = read_quat(reader);
  motion.dt = reader.f64();
  if (!reader.at_end() || !motion.rate.allFinite() || !quat || !std::isfinite(motion.dt)) return std::nullopt;
  motion.quat = *quat;
  return motion;
}

std::optional<double> decode_update_rate(View payload) {
  Reader reader(payload);
  const double rate = reader.f64();
  if (!reader.at_end() || !std::isfinite(rate) || rate <= 0) return std::nullopt;
  return rate;
}

void encode(Bytes& out, const PosQuat& pose) {
  put_sensor(out, pose.sensor);
  put(out, pose.position);
  put_quat(out, pose.quat);
}

void encode(Bytes& out, const Motion& motion) {
  put_sensor(out, motion.sensor);
  put(out, motion.rate);
  put_quat(out, motion.quat);
  put(out, motion.dt);
}

Quat orientation(const WireQuat& quat) {
  // Scaled by the largest component first: the norm of huge finite numbers may overflow.
  double largest = 0;
  for (const double q : quat) largest = std::max(largest, std::abs(q));
  if (!(largest > 1e-6)) return Quat::Identity();
  return Quat(quat[3] / largest, quat[0] / largest, quat[1] / largest, quat[2] / largest).normalized();
}

std::optional<ButtonChange> decode_button_change(View payload) {
  Reader reader(payload);
  const ButtonChange change{reader.i32(), reader.i32()};
  if (!reader.at_end() || change.button < 0 || change.button >= button_limit) return std::nullopt;
  return change;
}

std::optional<std::vector<std::int32_t>> decode_button_states(View payload) {
  Reader reader(payload);
  const std::int32_t count = reader.i32();
  if (!reader.ok() || count < 0 || count > button_limit) return std::nullopt;
  if (reader.left() != 4 * std::size_t(count)) return std::nullopt;
  std::vector<std::int32_t> states;
  states.resize(std::size_t(count));
  for (std::int32_t& state : states) state = reader.i32();
  return states;
}

void encode(Bytes& out, const ButtonChange& change) {
  put(out, change.button);
  put(out, change.state);
}

void encode(Bytes& out, const std::vector<std::int32_t>& states) {
  put(out, std::int32_t(states.size()));
  for (const std::int32_t state : states) put(out, state);
}

std::optional<Text> decode_text(View payload) {
  Reader reader(payload);
  Text text;
  text.severity = reader.u32();
  text.level = reader.u32();
  const std::string_view characters = text_of(reader.raw(text_limit));
  if (!reader.at_end() || text.severity > 2) return std::nullopt;
  text.text = characters.substr(0, characters.find('\0'));
  // Terminals obey control characters, and JSON must be UTF-8.
  std::replace_if(
      text.text.begin(), text.text.end(), [](char c) { return !is_printable(c); }, ' ');
  return text;
}

void encode(Bytes& out, const Text& text) {
  put(out, text.severity);
  put(out, text.level);
  const std::size_t end = out.size() + text_limit;
  put(out, std::string_view(text.text).substr(0, text_limit - 1));
  out.resize(end);
}

}  // namespace intaglio::haptics::vrpn
