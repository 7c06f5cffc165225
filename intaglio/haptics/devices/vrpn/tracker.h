// Payloads of tracker messages. Decoders give nothing for a wrong size, a sensor out of range, or a number
// that is not finite. Metres, seconds; quaternions are x y z w as sent, not normalised.
#pragma once

#include <array>
#include <optional>

#include "intaglio/haptics/devices/vrpn/wire.h"

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

}  // namespace intaglio::haptics::vrpn
