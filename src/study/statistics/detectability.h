// d' of a choice among m alternatives: how far apart signal and noise lie, in deviations of the noise, for an
// unbiased observer who takes the alternative that looks greatest.
//
//   rate = ∫ φ(x - d') Φ(x)^(m - 1) dx
//
// 0 at chance, 1/m; negative below it; infinite at rates of 1 and 0, which few trials reach by luck: the
// interval of the rate then gives d' one finite end. Source: Hacker and Ratcliff, "A revised table of d'
// for M-alternative forced choice", 1979. The integral is a sum at equal distances, exact to 1e-14. Any
// thread; 0.5 ms.
#pragma once

#include "intaglio/error.h"
#include "study/statistics/proportion.h"

namespace intaglio::statistics {

// The rate that an observer of a d' has; `alternatives` of at least 2.
double choice_rate(double d_prime, int alternatives);

// The d' at which a rate is expected. Errors: a rate outside [0, 1], fewer than two alternatives.
Result<double> detectability(double rate, int alternatives);

struct Detectability {
  double d_prime = 0;
  Interval interval;  // the d' of the ends of the rate's interval
};

Result<Detectability> detectability(const Proportion& proportion, int alternatives);

}  // namespace intaglio::statistics
