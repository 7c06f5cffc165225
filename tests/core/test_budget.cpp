#include <doctest/doctest.h>

#include "core/budget.h"

using namespace intaglio;

TEST_CASE("what needs more than is allowed is refused with its parts and the option that allows it") {
  MemoryCost cost("textures", 0.5e9);
  cost.add("bodies", 4.9e9);
  cost.add("sound", 1e6);
  CHECK(check_memory("big.toml", cost, 6'000'000'000));
  const auto refused = check_memory("big.toml", cost, 2'000'000'000);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message() ==
        "big.toml: would need about 5.4 GB (bodies 4.9 GB, textures 500 MB), more than the 2 GB allowed; "
        "pass --allow-memory 6G");
}

TEST_CASE("the option that an error suggests allows what it refused") {
  for (const double bytes : {1.0, 999e3, 10e6, 123.4e6, 999.6e6, 1e9, 1.01e9, 2e9, 7.3e10}) {
    const auto refused = check_memory("x", {"all", bytes}, 0);
    REQUIRE_FALSE(refused);
    const std::string fix = refused.error().fix;
    const auto allowed = memory_size(fix.substr(fix.rfind(' ') + 1));
    REQUIRE(allowed);
    CHECK(check_memory("x", {"all", bytes}, *allowed));
  }
}

TEST_CASE("parts of one name add up") {
  MemoryCost cost("a", 1);
  cost.add("b", 2);
  cost.add("a", 3);
  CHECK(cost.total() == 6);
  CHECK(MemoryCost().total() == 0);
  CHECK(MemoryCost().parts().empty());
}

TEST_CASE("sizes are a number and a unit") {
  CHECK(memory_size("8G") == 8'000'000'000);
  CHECK(memory_size("1.5G") == 1'500'000'000);
  CHECK(memory_size("500M") == 500'000'000);
  for (const char* wrong : {"", "G", "8", "8 G", "8GB", "-1G", "0G", "1e9G", "nanG", "infG", "0x1G"})
    CHECK_FALSE(memory_size(wrong));
}
