#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <thread>

#include "core/lock_free.h"

using intaglio::Latest;

TEST_CASE("the reader gets the newest value every time, and a default one before the first") {
  Latest<int> slot;
  CHECK(slot.fetch() == 0);
  slot.publish(1);
  slot.publish(2);
  CHECK(slot.fetch() == 2);
  CHECK(slot.fetch() == 2);
  slot.publish(3);
  CHECK(slot.fetch() == 3);
}

TEST_CASE("between two threads no value is torn, none goes back in time, and the last one arrives") {
  using Block = std::array<std::uint64_t, 64>;
  Latest<Block> slot;
  constexpr std::uint64_t last = 300000;
  std::thread writer([&] {
    for (std::uint64_t k = 1; k <= last; ++k) {
      Block block;
      block.fill(k);
      slot.publish(block);
    }
  });
  std::uint64_t newest = 0;
  bool torn = false, backwards = false;
  while (newest < last) {
    const Block& block = slot.fetch();
    for (const std::uint64_t v : block) torn |= v != block[0];
    backwards |= block[0] < newest;
    newest = block[0];
  }
  writer.join();
  CHECK_FALSE(torn);
  CHECK_FALSE(backwards);
}
