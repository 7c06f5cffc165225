// Orders of trials: the laws of squares, of shuffles within constraints, and of their random streams.
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "study/design/order.h"

using namespace intaglio;
using namespace intaglio::study;

namespace {

bool is_permutation_of(std::vector<int> order, int n) {
  std::vector<int> plain(std::size_t(n), 0);
  std::iota(plain.begin(), plain.end(), 0);
  std::sort(order.begin(), order.end());
  return order == plain;
}

// How often each value stands in each place, and follows each other one, over some orders.
struct Counts {
  std::map<std::pair<int, int>, int> places, successions;
  void add(const std::vector<int>& order) {
    for (std::size_t k = 0; k < order.size(); ++k) {
      ++places[{order[k], int(k)}];
      if (k > 0) ++successions[{order[k - 1], order[k]}];
    }
  }
  static bool are_all(const std::map<std::pair<int, int>, int>& counts, std::size_t size, int count) {
    return counts.size() == size &&
           std::all_of(counts.begin(), counts.end(), [&](const auto& each) { return each.second == count; });
  }
};

}  // namespace

TEST_CASE(
    "over a period of participants squares put each symbol once in each place, Williams' also after each") {
  for (int n = 1; n <= 13; ++n) {
    CAPTURE(n);
    for (const Order order : {Order::latin, Order::williams}) {
      const int period = period_of(order, n);
      CHECK(period == (order == Order::latin || n % 2 == 0 || n == 1 ? n : 2 * n));
      // The second group has a square of its own.
      for (const int first : {1, period + 1}) {
        Counts counts;
        for (int participant = first; participant < first + period; ++participant) {
          const auto row = order_of(order, n, participant, 42, "x");
          CHECK(is_permutation_of(row, n));
          counts.add(row);
        }
        const std::size_t squares = std::size_t(n) * std::size_t(n);
        CHECK(Counts::are_all(counts.places, squares, period / n));
        if (order == Order::williams && n > 1)
          CHECK(Counts::are_all(counts.successions, squares - std::size_t(n), period / n));
      }
    }
  }
}

TEST_CASE("orders depend on seed, purpose and participant, and on nothing else") {
  const auto order = order_of(Order::shuffle, 10, 3, 42, "main");
  CHECK(order == order_of(Order::shuffle, 10, 3, 42, "main"));
  CHECK(order != order_of(Order::shuffle, 10, 4, 42, "main"));
  CHECK(order != order_of(Order::shuffle, 10, 3, 43, "main"));
  CHECK(order != order_of(Order::shuffle, 10, 3, 42, "other"));
  // The value is of another implementation, in Python: FNV-1a of "42/main/2", SplitMix64, Fisher and Yates.
  CHECK((order == std::vector<int>{3, 1, 8, 9, 7, 5, 0, 6, 4, 2}));
}

TEST_CASE("a shuffle has each order equally often") {
  std::map<std::vector<int>, int> counts;
  Random random(7);
  constexpr int draws = 24'000;
  for (int k = 0; k < draws; ++k) ++counts[shuffled(4, random)];
  CHECK(counts.size() == 24);
  // 1000 each, with a deviation of 31: beyond five of them once in two million.
  for (const auto& [order, count] : counts) CHECK(std::abs(count - 1000) < 155);
}

TEST_CASE("a constrained shuffle keeps its constraints, or says that none does") {
  rc::check([] {
    const int conditions = *rc::gen::inRange(2, 5), each = *rc::gen::inRange(1, 8);
    const int materials = *rc::gen::inRange(3, 7);
    Constraints constraints{*rc::gen::inRange(1, 4), *rc::gen::inRange(1, 4)};
    std::vector<int> condition, material;
    for (int k = 0; k < conditions * each; ++k) {
      condition.push_back(k % conditions);
      material.push_back(k % materials);
    }
    Random random(*rc::gen::arbitrary<std::uint64_t>());
    const auto order = constrained_shuffle(condition, material, constraints, random);
    if (!order) return;
    RC_ASSERT(is_permutation_of(*order, conditions * each));
    int run = 0;
    for (std::size_t k = 0; k < order->size(); ++k) {
      const auto at = [&](std::size_t place) { return std::size_t((*order)[place]); };
      run = k > 0 && condition[at(k)] == condition[at(k - 1)] ? run + 1 : 1;
      RC_ASSERT(run <= constraints.max_run);
      for (std::size_t back = 1; back < std::size_t(constraints.apart) && back <= k; ++back)
        RC_ASSERT(material[at(k)] != material[at(k - back)]);
    }
  });
  // Too tight for draws: ten conditions twice, each run of one; found by the search.
  std::vector<int> halves;
  for (int k = 0; k < 20; ++k) halves.push_back(k < 10 ? 0 : 1);
  Random random(1);
  const auto alternating = constrained_shuffle(halves, std::vector<int>(20, -1), {1, 0}, random);
  REQUIRE(alternating);
  for (std::size_t k = 1; k < 20; ++k)
    CHECK(halves[std::size_t((*alternating)[k])] != halves[std::size_t((*alternating)[k - 1])]);
  // Impossible: eleven of one and one of the other.
  std::vector<int> uneven(12, 0);
  uneven[3] = 1;
  const auto none = constrained_shuffle(uneven, std::vector<int>(12, -1), {1, 0}, random);
  REQUIRE_FALSE(none);
  CHECK(none.error().what.find("max_run") != std::string::npos);
}
