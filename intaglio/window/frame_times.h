// How long pictures take: for the panel, the report, and how coarse the picture must be.
#pragma once

#include <algorithm>
#include <vector>

namespace intaglio::window {

class FrameTimes {
 public:
  void add(double seconds) {
    all_.push_back(static_cast<float>(seconds));
    smooth_ = all_.size() == 1 ? seconds : smooth_ + 0.1 * (seconds - smooth_);
  }
  double smooth() const { return smooth_; }
  std::size_t count() const { return all_.size(); }
  std::size_t over(double seconds) const {
    return static_cast<std::size_t>(
        std::count_if(all_.begin(), all_.end(), [&](float t) { return static_cast<double>(t) > seconds; }));
  }
  double quantile(double q) const {
    if (all_.empty()) return 0;
    std::vector<float> sorted = all_;
    std::sort(sorted.begin(), sorted.end());
    return static_cast<double>(sorted[std::min(
        sorted.size() - 1, static_cast<std::size_t>(q * static_cast<double>(sorted.size())))]);
  }

 private:
  std::vector<float> all_;
  double smooth_ = 0;
};

}  // namespace intaglio::window
