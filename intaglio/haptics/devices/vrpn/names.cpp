#include "intaglio/haptics/devices/vrpn/names.h"

#include <algorithm>

namespace intaglio::haptics::vrpn {

std::optional<Type> type_named(std::string_view name) {
  const auto found = std::find(type_names.begin(), type_names.end(), name);
  if (found == type_names.end()) return std::nullopt;
  return static_cast<Type>(found - type_names.begin());
}

// The place of `id` in a table that grows as far as a believable id asks; null beyond.
template <class Table>
static typename Table::value_type* place(Table& table, std::int32_t id) {
  if (id < 0 || id >= id_limit) return nullptr;
  const auto at = static_cast<std::size_t>(id);
  if (at >= table.size()) table.resize(at + 1);
  return &table[at];
}

bool PeerNames::learn_sender(std::int32_t id, std::string_view name) {
  std::string* const known = place(senders_, id);
  if (known) *known = name;
  return known != nullptr;
}

bool PeerNames::learn_type(std::int32_t id, std::string_view name) {
  std::optional<Type>* const known = place(types_, id);
  if (known) *known = type_named(name);
  return known != nullptr;
}

std::string_view PeerNames::sender(std::int32_t id) const {
  return id >= 0 && static_cast<std::size_t>(id) < senders_.size() ? senders_[static_cast<std::size_t>(id)]
                                                                   : std::string_view();
}

std::optional<Type> PeerNames::type(std::int32_t id) const {
  return id >= 0 && static_cast<std::size_t>(id) < types_.size() ? types_[static_cast<std::size_t>(id)]
                                                                 : std::nullopt;
}

std::vector<std::string> PeerNames::senders() const {
  std::vector<std::string> named;
  std::copy_if(senders_.begin(), senders_.end(), std::back_inserter(named),
               [](const std::string& name) { return !name.empty(); });
  return named;
}

bool PeerNames::knows(Type type) const {
  return std::find(types_.begin(), types_.end(), std::optional(type)) != types_.end();
}

}  // namespace intaglio::haptics::vrpn
