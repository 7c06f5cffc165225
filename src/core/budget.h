// An estimate of the memory that a file asks for, made from its header or its counts, and the check of it
// against what is allowed (intaglio/memory.h).
//
// An estimate is of the largest resident size, within a factor of two; its constants are in the code that
// allocates, and `tools/budget_table` prints estimate and measurement side by side. 1 GB is 10^9 bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/memory.h"

namespace intaglio {

class MemoryCost {
 public:
  MemoryCost() = default;
  MemoryCost(const std::string& part, double bytes) { add(part, bytes); }

  // Adds to the part of that name: "textures", "bodies".
  void add(const std::string& part, double bytes);
  double total() const;
  // "bodies 4.9 GB, textures 0.5 GB": the largest first, without those below a hundredth.
  std::string parts() const;

 private:
  std::vector<std::pair<std::string, double>> parts_;
};

// Fails when the cost is beyond the budget: "big.toml: would need about 5.4 GB (bodies 4.9 GB, textures 0.5
// GB), more than the 2 GB allowed; pass --allow-memory 6G".
Result<void> check_memory(const std::string& where, const MemoryCost& cost, std::uint64_t allowed);

// "5.4 GB", "340 MB".
std::string memory_text(double bytes);

// The bytes of "8G", "1.5G" or "500M"; absent for anything else.
std::optional<std::uint64_t> memory_size(std::string_view text);

}  // namespace intaglio
