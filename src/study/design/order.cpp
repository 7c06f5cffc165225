#include "study/design/order.h"

#include <fmt/format.h>

#include <cstddef>
#include <numeric>
#include <utility>

#include "core/hash.h"

namespace intaglio::study {

Random random_stream(std::uint64_t seed, const std::string& purpose, int number) {
  Hash hash;
  hash.add(fmt::format("{}/{}/{}", seed, purpose, number));
  return Random(hash.value());
}

int random_below(Random& random, int n) {
  // Values beyond the last whole multiple of n would favour small results.
  const std::uint64_t size = std::uint64_t(n), excess = (UINT64_MAX % size + 1) % size;
  while (true) {
    const std::uint64_t value = random.next();
    if (value <= UINT64_MAX - excess) return int(value % size);
  }
}

std::vector<int> shuffled(int n, Random& random) {
  std::vector<int> order(std::size_t(n), 0);
  std::iota(order.begin(), order.end(), 0);
  for (int k = n - 1; k > 0; --k)
    std::swap(order[std::size_t(k)], order[std::size_t(random_below(random, k + 1))]);
  return order;
}

std::vector<int> latin_row(int n, int row) {
  std::vector<int> order(std::size_t(n), 0);
  for (int k = 0; k < n; ++k) order[std::size_t(k)] = (row + k) % n;
  return order;
}

std::vector<int> williams_row(int n, int row) {
  std::vector<int> order(std::size_t(n), 0);
  // The first row goes 0, 1, n-1, 2, n-2, ...: its differences are all different. The rows beyond n, which an
  // odd n needs, are the first ones backwards.
  for (int k = 0; k < n; ++k) {
    const int first = k % 2 == 1 ? (k + 1) / 2 : (n - k / 2) % n;
    order[std::size_t(row < n ? k : n - 1 - k)] = (first + row) % n;
  }
  return order;
}

int period_of(Order order, int n) {
  if (order == Order::latin) return n;
  if (order == Order::williams) return n % 2 == 0 || n == 1 ? n : 2 * n;
  return 1;
}

std::vector<int> order_of(Order order, int n, int participant, std::uint64_t seed,
                          const std::string& purpose) {
  if (n < 1) return {};
  std::vector<int> plain(std::size_t(n), 0);
  std::iota(plain.begin(), plain.end(), 0);
  if (order == Order::fixed) return plain;
  const int period = period_of(order, n);
  Random random = random_stream(seed, purpose, (participant - 1) / period);
  if (order == Order::shuffle) return shuffled(n, random);
  const auto rows = shuffled(period, random);
  const auto symbols = shuffled(n, random);
  const auto places = order == Order::latin ? shuffled(n, random) : plain;
  const int row = rows[std::size_t((participant - 1) % period)];
  const auto of_square = order == Order::latin ? latin_row(n, row) : williams_row(n, row);
  std::vector<int> result(std::size_t(n), 0);
  for (std::size_t k = 0; k < result.size(); ++k)
    result[k] = symbols[std::size_t(of_square[std::size_t(places[k])])];
  return result;
}

namespace {

// Whether a trial may follow those placed so far.
class Follower {
 public:
  Follower(const std::vector<int>& conditions, const std::vector<int>& materials,
           const Constraints& constraints)
      : conditions_(conditions), materials_(materials), constraints_(constraints) {}

  bool may_follow(const std::vector<int>& placed, int trial) const {
    const std::size_t at = std::size_t(trial);
    int run = 1;
    for (auto it = placed.rbegin(); it != placed.rend() && conditions_[std::size_t(*it)] == conditions_[at];
         ++it)
      if (constraints_.max_run > 0 && ++run > constraints_.max_run) return false;
    int distance = 1;
    for (auto it = placed.rbegin(); it != placed.rend() && distance < constraints_.apart; ++it, ++distance)
      if (materials_[at] >= 0 && materials_[std::size_t(*it)] == materials_[at]) return false;
    return true;
  }

  bool keeps(const std::vector<int>& order) const {
    std::vector<int> placed;
    placed.reserve(order.size());
    for (const int trial : order) {
      if (!may_follow(placed, trial)) return false;
      placed.push_back(trial);
    }
    return true;
  }

 private:
  const std::vector<int>& conditions_;
  const std::vector<int>& materials_;
  const Constraints& constraints_;
};

// Depth first: in each place the trials that are left, in random order.
class ShuffleSearch {
 public:
  ShuffleSearch(const Follower& follower, int n, Random& random)
      : follower_(follower), left_(std::size_t(n), true), random_(random) {}

  bool search() {
    if (placed_.size() == left_.size()) return true;
    const auto candidates = shuffled(int(left_.size()), random_);
    for (const int trial : candidates) {
      if (!left_[std::size_t(trial)]) continue;
      if (++steps_ > most_steps_) return false;
      if (!follower_.may_follow(placed_, trial)) continue;
      left_[std::size_t(trial)] = false;
      placed_.push_back(trial);
      if (search()) return true;
      placed_.pop_back();
      left_[std::size_t(trial)] = true;
    }
    return false;
  }
  std::vector<int> take() { return std::move(placed_); }

 private:
  static constexpr int most_steps_ = 20'000;

  const Follower& follower_;
  std::vector<bool> left_;
  Random& random_;
  std::vector<int> placed_;
  int steps_ = 0;
};

}  // namespace

Result<std::vector<int>> constrained_shuffle(const std::vector<int>& conditions,
                                             const std::vector<int>& materials,
                                             const Constraints& constraints, Random& random) {
  const int n = int(conditions.size());
  const Follower follower(conditions, materials, constraints);
  constexpr int most_draws = 1000;
  for (int draw = 0; draw < most_draws; ++draw) {
    auto order = shuffled(n, random);
    if (follower.keeps(order)) return order;
  }
  ShuffleSearch search(follower, n, random);
  if (search.search()) return search.take();
  return fail("", "no order of the trials was found that keeps max_run and apart",
              "allow longer runs, or trials of one material closer together");
}

}  // namespace intaglio::study
