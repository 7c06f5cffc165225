#include "study/design/procedure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/portable_math.h"

namespace intaglio::study {

namespace {

class Staircase : public Procedure {
 public:
  explicit Staircase(const Adaptive& adaptive)
      : settings_(adaptive), amount_(adaptive.start), step_(adaptive.step) {}

  double amount() const override { return amount_; }

  void answer(bool is_noticed) override {
    ++answers_;
    int& run = is_noticed ? noticed_ : missed_;
    (is_noticed ? missed_ : noticed_) = 0;
    if (++run < (is_noticed ? settings_.down : settings_.up)) return;
    run = 0;
    turn(is_noticed ? -1 : 1);
    amount_ = std::clamp(amount_ + direction_ * step_, settings_.low, settings_.high);
  }

  bool is_done() const override { return int(reversals_.size()) >= settings_.reversals; }

  // The mean of the reversals but the first, and of an even number of them, so that upper and lower ones
  // weigh the same.
  ThresholdEstimate estimate() const override {
    const std::size_t skipped = std::min<std::size_t>(reversals_.size() / 3, 4);
    std::size_t first = skipped;
    if ((reversals_.size() - first) % 2 == 1 && reversals_.size() - first > 1) ++first;
    const double n = double(reversals_.size() - first);
    if (n < 1) return {amount_, settings_.high - settings_.low, answers_};
    double sum = 0, squares = 0;
    for (std::size_t k = first; k < reversals_.size(); ++k) sum += reversals_[k];
    for (std::size_t k = first; k < reversals_.size(); ++k) squares += std::pow(reversals_[k] - sum / n, 2);
    return {sum / n, n > 1 ? std::sqrt(squares / (n - 1) / n) : settings_.high - settings_.low, answers_};
  }

 private:
  void turn(int direction) {
    if (direction_ != 0 && direction != direction_) {
      reversals_.push_back(amount_);
      step_ = std::max(0.5 * step_, settings_.smallest_step);
    }
    direction_ = direction;
  }

  Adaptive settings_;
  double amount_, step_;
  int direction_ = 0, noticed_ = 0, missed_ = 0, answers_ = 0;
  std::vector<double> reversals_;
};

double entropy_of(double p) {
  return p <= 0 || p >= 1 ? 0 : -p * elementary::log(p) - (1 - p) * elementary::log(1 - p);
}

class Quest : public Procedure {
 public:
  explicit Quest(const Adaptive& adaptive)
      : settings_(adaptive),
        amounts_(quest_amounts(adaptive)),
        thresholds_(quest_thresholds(adaptive)),
        slopes_(quest_slopes(adaptive)),
        prior_(thresholds_.size() * slopes_.size(), 1.0 / double(thresholds_.size() * slopes_.size())) {
    for (const double amount : amounts_)
      for (const double threshold : thresholds_)
        for (const double slope : slopes_) {
          noticed_.push_back(weibull(amount, threshold, slope, adaptive.guess, adaptive.lapse));
          entropy_.push_back(entropy_of(noticed_.back()));
        }
    choose();
  }

  double amount() const override { return amounts_[next_]; }

  void answer(bool is_noticed) override {
    ++answers_;
    const double* const likelihood = &noticed_[next_ * prior_.size()];
    double total = 0;
    for (std::size_t k = 0; k < prior_.size(); ++k) {
      prior_[k] *= is_noticed ? likelihood[k] : 1 - likelihood[k];
      total += prior_[k];
    }
    // An answer that no threshold allows (guess and lapse 0) says that the model is wrong: it is left out.
    if (!(total > 0)) {
      std::fill(prior_.begin(), prior_.end(), 1.0 / double(prior_.size()));
    } else {
      for (double& p : prior_) p /= total;
    }
    choose();
  }

  bool is_done() const override {
    if (settings_.precision <= 0) return false;
    const ThresholdEstimate now = estimate();
    constexpr int least_answers = 10;
    return now.answers >= least_answers && now.deviation < settings_.precision * now.threshold;
  }

  ThresholdEstimate estimate() const override {
    double mean = 0, square = 0;
    for (std::size_t k = 0; k < prior_.size(); ++k) {
      const double threshold = thresholds_[k / slopes_.size()];
      mean += prior_[k] * threshold;
      square += prior_[k] * threshold * threshold;
    }
    return {mean, std::sqrt(std::max(square - mean * mean, 0.0)), answers_};
  }

 private:
  // The expected entropy after an answer is that of now less the information of the answer about the
  // parameters: H(mean probability) - mean H(probability). So the largest information is chosen.
  void choose() {
    double best = -1;
    for (std::size_t k = 0; k < amounts_.size(); ++k) {
      const double* const likelihood = &noticed_[k * prior_.size()];
      const double* const entropy = &entropy_[k * prior_.size()];
      double noticed = 0, noise = 0;
      for (std::size_t j = 0; j < prior_.size(); ++j) {
        noticed += prior_[j] * likelihood[j];
        noise += prior_[j] * entropy[j];
      }
      const double information = entropy_of(noticed) - noise;
      if (information <= best) continue;
      best = information;
      next_ = k;
    }
  }

  Adaptive settings_;
  std::vector<double> amounts_, thresholds_, slopes_, prior_;
  std::vector<double> noticed_, entropy_;  // of each amount, threshold, slope
  std::size_t next_ = 0;
  int answers_ = 0;
};

}  // namespace

double weibull(double amount, double threshold, double slope, double guess, double lapse) {
  const double power = amount <= 0 ? 0 : elementary::exp(slope * elementary::log(amount / threshold));
  // exp(-700) is nothing beside 1, and within the range of the elementary function.
  return guess + (1 - guess - lapse) * (1 - elementary::exp(-std::min(power, 700.0)));
}

std::vector<double> quest_amounts(const Adaptive& adaptive) {
  std::vector<double> amounts;
  for (int k = 0; k < adaptive.grid; ++k)
    amounts.push_back(adaptive.low + (adaptive.high - adaptive.low) * k / (adaptive.grid - 1));
  return amounts;
}

std::vector<double> quest_thresholds(const Adaptive& adaptive) {
  auto thresholds = quest_amounts(adaptive);
  std::erase_if(thresholds, [](double amount) { return amount <= 0; });
  return thresholds;
}

std::vector<double> quest_slopes(const Adaptive& adaptive) {
  constexpr int count = 12;
  std::vector<double> slopes;
  const double ratio = elementary::log(adaptive.slope_high / adaptive.slope_low);
  for (int k = 0; k < count; ++k)
    slopes.push_back(adaptive.slope_low * elementary::exp(ratio * k / (count - 1)));
  return slopes;
}

std::unique_ptr<Procedure> make_procedure(const Adaptive& adaptive) {
  if (adaptive.method == Adaptive::Method::quest) return std::make_unique<Quest>(adaptive);
  return std::make_unique<Staircase>(adaptive);
}

}  // namespace intaglio::study
