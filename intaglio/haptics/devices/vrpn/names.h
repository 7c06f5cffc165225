// The names by which two VRPN sides understand each other: each numbers its senders and message types as it
// likes and tells the other the names. Here are the types we know, and the table of what a peer's numbers
// mean.
//
// A peer's numbers are trusted nowhere: at most id_limit of each, names within name_limit. A number that was
// never named means nothing (UDP data may overtake the TCP message that names its type) and is no fault.
#pragma once

#include <array>
#include <optional>

#include "intaglio/haptics/devices/vrpn/message.h"

namespace intaglio::haptics::vrpn {

// Our own type ids are these values.
enum class Type : std::int32_t {
  ping,
  pong,
  text,
  pos_quat,
  velocity,
  acceleration,
  set_update_rate,
  button_change,
  button_states,
  force,
  force_field,
  plane,
  plane2,
  scp,
  force_error,
};

inline constexpr std::array<std::string_view, 15> type_names = {
    "vrpn_Base ping_message",       "vrpn_Base pong_message",       "vrpn_Base text_message",
    "vrpn_Tracker Pos_Quat",        "vrpn_Tracker Velocity",        "vrpn_Tracker Acceleration",
    "vrpn_Tracker set_update_rate", "vrpn_Button Change",           "vrpn_Button States",
    "vrpn_ForceDevice Force",       "vrpn_ForceDevice Force_Field", "vrpn_ForceDevice Plane",
    "vrpn_ForceDevice Plane2",      "vrpn_ForceDevice SCP",         "vrpn_ForceDevice Force_Error",
};

inline constexpr std::size_t name_limit = 100;  // bytes, with the NUL
inline constexpr std::int32_t id_limit = 2000;

// The type of that name, if we know it.
std::optional<Type> type_named(std::string_view name);

// What a peer's ids mean.
class PeerNames {
 public:
  // Both refuse an id out of range.
  bool learn_sender(std::int32_t id, std::string_view name);
  bool learn_type(std::int32_t id, std::string_view name);

  // Empty when the peer never named it.
  std::string_view sender(std::int32_t id) const;
  std::optional<Type> type(std::int32_t id) const;
  // In the order of the ids.
  std::vector<std::string> senders() const;
  // Whether the peer has named this type.
  bool knows(Type type) const;

 private:
  std::vector<std::string> senders_;
  std::vector<std::optional<Type>> types_;
};

}  // namespace intaglio::haptics::vrpn
