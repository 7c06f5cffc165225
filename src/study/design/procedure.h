// Adaptive procedures: each answer decides the next amount, until the threshold is known.
//
// A staircase (transformed up and down) converges to the amount that is noticed with the probability p at
// which a step down and one up are as likely: p^down = 1/2 where up is 1 (70.7 % for down = 2). Source:
// Levitt, Transformed up-down methods in psychoacoustics, 1971.
//
// QUEST+ keeps the probability of each threshold and slope of a Weibull function on a grid,
//   P(noticed | x) = guess + (1 - guess - lapse) (1 - exp(-(x / threshold)^slope)),
// and presents the amount whose answer is expected to leave the least entropy. Its threshold is thus the
// amount noticed, guesses and lapses aside, with probability 1 - 1/e. Source: Watson, QUEST+: A general
// multidimensional Bayesian adaptive psychometric method, 2017.
//
// The state follows from the answers in order, so that a session resumes by giving them again; elementary
// functions are core's, so that amounts are the same on every machine. One thread. Cost of QUEST+: about 2 ms
// an answer for 61 amounts.
#pragma once

#include <memory>
#include <vector>

#include "study/design/design.h"

namespace intaglio::study {

struct ThresholdEstimate {
  double threshold = 0;  // in the amount's unit
  double deviation = 0;  // of it; of a staircase that of its reversals' mean
  int answers = 0;
};

class Procedure {
 public:
  virtual ~Procedure() = default;
  // To be presented next.
  virtual double amount() const = 0;
  virtual void answer(bool is_noticed) = 0;
  virtual bool is_done() const = 0;
  virtual ThresholdEstimate estimate() const = 0;
};

std::unique_ptr<Procedure> make_procedure(const Adaptive& adaptive);

// The psychometric function of QUEST+.
double weibull(double amount, double threshold, double slope, double guess, double lapse);

// Thresholds and slopes of QUEST+'s grid; amounts: from low to high, evenly.
std::vector<double> quest_amounts(const Adaptive& adaptive);
std::vector<double> quest_thresholds(const Adaptive& adaptive);  // the amounts above 0
std::vector<double> quest_slopes(const Adaptive& adaptive);      // 12, evenly by their logarithm

}  // namespace intaglio::study
