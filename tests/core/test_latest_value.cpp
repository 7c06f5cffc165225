#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <thread>

#include "intaglio/core/latest_value.h"

using intaglio::LatestValue;

TEST_CASE("the reader gets the newest value once; before any it has the initial one") {
  LatestValue<int> slot(7);
  CHECK_FALSE(slot.update());
  CHECK(slot.value() == 7);
  slot.publish(1);
  slot.publish(2);
  CHECK(slot.update());
  CHECK(slot.value() == 2);
  CHECK_FALSE(slot.update());
  CHECK(slot.value() == 2);
}

TEST_CASE("between two threads no value is torn, none goes back in time, and the last one arrives") {
  using Block = std::array<std::uint64_t, 64>;
  LatestValue<Block> slot{Block{}};
  constexpr std::uint64_t last = 300000;
  std::thread writer([&] {
    for (std::uint64_t k = 1; k <= last; ++k) {
      slot.draft().fill(k);
      slot.publish();
    }
  });
  std::uint64_t newest = 0;
  bool torn = false, backwards = false;
  while (newest < last) {
    if (!slot.update()) continue;
    const Block& block = slot.value();
    for (const std::uint64_t v : block) torn |= v != block[0];
    backwards |= block[0] <= newest;
    newest = block[0];
  }
  writer.join();
  CHECK_FALSE(torn);
  CHECK_FALSE(backwards);
}
