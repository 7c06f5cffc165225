// Distributions that tests, intervals and power need: normal, Student's t (central and not), chi-squared,
// beta, binomial.
//
// Probabilities by Boost.Math in double precision: relative errors of about 1e-13, of the noncentral t
// 1e-10. Equal to within that on every machine, not to the bit: the C library's exponential is in them.
// Nothing throws: an argument outside the domain gives not a number, as does a not-a-number. Any thread;
// about a microsecond, the noncentral ones about ten.
#pragma once

#include <functional>
#include <limits>

namespace intaglio::statistics {

// Where there is no number: the note beside it says why.
inline constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

double normal_density(double x);
double normal_cdf(double x);
double normal_upper(double x);     // 1 - cdf, exact in the tail
double normal_quantile(double p);  // infinite at 0 and 1

// Degrees of freedom above 0, whole or not; infinite ones give the normal distribution.
double t_cdf(double t, double df);
double t_upper(double t, double df);
double t_two_sided(double t, double df);  // P(|T| >= |t|)
double t_quantile(double p, double df);

double chi_squared_upper(double x, double df);

// The noncentral t: (Z + noncentrality) / sqrt(chi-squared / df).
double noncentral_t_cdf(double t, double df, double noncentrality);
double noncentral_t_upper(double t, double df, double noncentrality);
// The noncentrality at which P(T <= t) is p, in (0, 1): what intervals of effect sizes are made of.
double noncentrality(double t, double df, double p);

// The x below which a beta variable lies with probability p.
double beta_quantile(double p, double a, double b);

// Successes of `trials` with chance `p` each.
double binomial_pmf(double successes, double trials, double p);
double binomial_cdf(double successes, double trials, double p);
double binomial_upper(double successes, double trials, double p);  // P(X >= successes)

double log_gamma(double x);

// Where a function that falls or rises through 0 between low and high does so, to the last bit, by
// bisection. Not a number where the ends have one sign, or a value is not a number.
double find_root(const std::function<double(double)>& function, double low, double high);

}  // namespace intaglio::statistics
