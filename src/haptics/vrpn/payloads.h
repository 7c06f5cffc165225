// Payloads of tracker messages. Decoders give nothing for a wrong size, a sensor out of range, or a number
// that is not finite. Metres, seconds; quaternions are x y z w as sent, not normalised.
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

// Velocity and acceleration have one layout: the rotation is the one made in `dt`.
struct Motion {
  std::int32_t sensor = 0;
  Vec3 rate = Vec3::Zero();  // m/s or m/s²
  WireQuat quat = {0, 0, 0, 1};
  double dt = 0;  // s
};

std::optional<PosQuat> decode_pos_quat(View payload);
std::optional<Motion> decode_motion(View payload);
// Reports a second, greater than zero.
std::optional<double> decode_update_rate(View payload);

void encode(Bytes& out, const PosQuat& pose);
void encode(Bytes& out, const Motion& motion);

// Unit; identity when the peer sent none worth the name (a tracker of positions only may send zeros).
Quat orientation(const WireQuat& quat);

// Of any message's payload.
std::optional<WireQuat> read_quat(Reader& reader);
void put_quat(Bytes& out, const WireQuat& quat);

// Payloads of button messages. Decoders give nothing for a wrong size or a button out of range.

inline constexpr std::int32_t button_limit = 256;

struct ButtonChange {
  std::int32_t button = 0;
  std::int32_t state = 0;  // 0 released, otherwise pressed
};

std::optional<ButtonChange> decode_button_change(View payload);
// The state of each button.
std::optional<std::vector<std::int32_t>> decode_button_states(View payload);

void encode(Bytes& out, const ButtonChange& change);
void encode(Bytes& out, const std::vector<std::int32_t>& states);

// Payload of a text message: what a device wants its user to read. Severity 0 normal, 1 warning, 2 error.

inline constexpr std::size_t text_limit = 1024;  // bytes, with the NUL

struct Text {
  std::uint32_t severity = 0;
  std::uint32_t level = 0;
  std::string text;  // up to its first NUL; all but printable ASCII become spaces
};

// Nothing for a wrong size or an unknown severity.
std::optional<Text> decode_text(View payload);
// Cuts what is too long.
void encode(Bytes& out, const Text& text);

}  // namespace intaglio::haptics::vrpn
