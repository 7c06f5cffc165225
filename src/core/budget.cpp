#include "core/budget.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace intaglio {

void MemoryCost::add(const std::string& part, double bytes) {
  const auto found =
      std::find_if(parts_.begin(), parts_.end(), [&](const auto& entry) { return entry.first == part; });
  if (found == parts_.end()) {
    parts_.emplace_back(part, bytes);
  } else {
    found->second += bytes;
  }
}

double MemoryCost::total() const {
  return std::accumulate(parts_.begin(), parts_.end(), 0.0,
                         [](double sum, const auto& entry) { return sum + entry.second; });
}

std::string MemoryCost::parts() const {
  auto sorted = parts_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string out;
  for (const auto& [part, bytes] : sorted)
    if (bytes >= 0.01 * total())
      out += fmt::format("{}{} {}", out.empty() ? "" : ", ", part, memory_text(bytes));
  return out;
}

Result<void> check_memory(const std::string& where, const MemoryCost& cost, std::uint64_t allowed) {
  const double total = cost.total();
  if (total <= double(allowed)) return {};
  const std::string enough = total < 1e9 ? fmt::format("{:.0f}M", 10 * std::ceil(total / 1e7))
                                         : fmt::format("{:.0f}G", std::ceil(total / 1e9));
  return fail(where,
              fmt::format("would need about {} ({}), more than the {} allowed", memory_text(total),
                          cost.parts(), memory_text(double(allowed))),
              "pass --allow-memory " + enough);
}

std::string memory_text(double bytes) {
  if (bytes < 0.9995e9) return fmt::format("{:.0f} MB", bytes / 1e6);
  return bytes < 9.95e9 ? fmt::format("{:.2g} GB", bytes / 1e9) : fmt::format("{:.0f} GB", bytes / 1e9);
}

std::optional<std::uint64_t> memory_size(std::string_view text) {
  if (text.empty()) return std::nullopt;
  const double unit = text.back() == 'G' ? 1e9 : text.back() == 'M' ? 1e6 : 0;
  double value = 0;
  const char* const last = text.data() + text.size() - 1;
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (unit == 0 || error != std::errc() || end != last || !(value > 0 && value * unit <= 1e15))
    return std::nullopt;
  return std::uint64_t(value * unit);
}

}  // namespace intaglio
