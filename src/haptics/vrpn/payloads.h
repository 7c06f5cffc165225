// Payloads of tracker, button and text messages.
//
// Decoders return nothing for a wrong size, a sensor or button out of range, or a number that is not finite.
// Metres, seconds; quaternions are x y z w as sent, not normalised.
#pragma once

#include <array>
#include <optional>

#include "haptics/vrpn/message.h"

namespace intaglio::haptics::vrpn {

inline constexpr std::int32_t sensor_limit = 256;

using WireQuat = std::array<double, 4>;  // x y z w

struct PosQuat {
  std::int32_t sensor = 0;
  Vec3 position = Vec3::Zero();  // m, device frame
  WireQuat quat = {0, 0, 0, 1};
};

// Payload of velocity and of acceleration; `quat` is the rotation in `dt`.
struct Motion {
  std::int32_t sensor = 0;
  Vec3 rate = Vec3::Zero();  // m/s or m/s²
  WireQuat quat = {0, 0, 0, 1};
  double dt = 0;  // s
};

std::optional<PosQuat> decode_pos_quat(View payload);
std::optional<Motion> decode_motion(View payload);
// Reports per second, greater than zero.
std::optional<double> decode_update_rate(View payload);

void encode(Bytes& out, const PosQuat& pose);
void encode(Bytes& out, const Motion& motion);

// Normalised; identity for a quaternion of (nearly) zero, as position-only trackers send.
Quat orientation(const WireQuat& quat);

// Part of several payloads.
std::optional<WireQuat> read_quat(Reader& reader);
void put_quat(Bytes& out, const WireQuat& quat);

inline constexpr std::int32_t button_limit = 256;

struct ButtonChange {
  std::int32_t button = 0;
  std::int32_t state = 0;  // 0 released, otherwise pressed
};

std::optional<ButtonChange> decode_button_change(View payload);
// The states of all buttons.
std::optional<std::vector<std::int32_t>> decode_button_states(View payload);

void encode(Bytes& out, const ButtonChange& change);
void encode(Bytes& out, const std::vector<std::int32_t>& states);

inline constexpr std::size_t text_limit = 1024;  // bytes, with the NUL

// A message for the device's user.
struct Text {
  std::uint32_t severity = 0;  // 0 normal, 1 warning, 2 error
  std::uint32_t level = 0;
  std::string text;  // up to its first NUL; characters other than printable ASCII become spaces
};

// Also nothing for an unknown severity.
std::optional<Text> decode_text(View payload);
// Truncates the text to text_limit.
void encode(Bytes& out, const Text& text);

}  // namespace intaglio::haptics::vrpn
