// How late one series is against another, and how surely that is known.
//
// The lag of the best correlation, between values by the vertex of a parabola. Its standard error is that of
// the lag in delivered(t) = a reference(t - lag) + b by least squares, with a residual that is correlated in
// time (Newey and West 1987). Where many lags are measured, their own spread is separated from that error,
// and each is drawn towards the common one by as much as its error explains (empirical Bayes; DerSimonian
// and Laird 1986, Efron and Morris 1973): a series that hardly says when is not taken as late. Pure; any
// thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace intaglio::evaluate {

struct Lag {
  double values = 0;       // by which `delivered` is later
  double correlation = 0;  // Pearson's, at that lag
  double error = 0;        // standard error of `values`
};

// The lag for reference[from..to), within `reach` values of `around`. If two lags fit equally well, the
// nearer one is taken.
Lag best_lag(std::span<const double> reference, std::span<const double> delivered, std::int64_t from,
             std::int64_t to, std::int64_t around, std::int64_t reach);

// Lags about a common one, each drawn towards it by what its error explains of their spread.
std::vector<double> drawn_together(std::span<const Lag> lags, double common);

}  // namespace intaglio::evaluate
