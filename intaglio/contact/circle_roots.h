// The zeros of a cos t + b sin t + c cos 2t + d sin 2t in an arc: where a circle's distance to a straight
// line is stationary. Internal to contact/.
//
// Isolated by bounds of the first and the second derivative, so that none is lost, also when two are close
// together. Up to four in a whole turn. Bounded work, no allocation.
#pragma once

#include <cmath>

#include "intaglio/core/elementary.h"

namespace intaglio::contact {

struct CircleWave {
  double a, b, c, d;

  // Value and slope at an angle.
  struct At {
    double value, slope;
  };
  At at(double angle) const {
    const auto [sine, cosine] = elementary::sin_cos(angle);
    const double cosine2 = cosine * cosine - sine * sine, sine2 = 2 * sine * cosine;
    return {a * cosine + b * sine + c * cosine2 + d * sine2,
            b * cosine - a * sine + 2 * (d * cosine2 - c * sine2)};
  }

  // Calls visit(angle) for the zeros in middle - half..middle + half; two that are within 1e-7 of each other
  // may be one.
  template <class Visit>
  void for_each_zero(double middle, double half, const Visit& visit) const {
    const At here = at(middle);
    const double one = elementary::hypot(a, b), two = elementary::hypot(c, d);
    if (std::abs(here.value) > (one + 2 * two) * half) return;
    if (std::abs(here.slope) > (one + 4 * two) * half) {
      const double from = middle - half, to = middle + half, f_from = at(from).value, f_to = at(to).value;
      if ((f_from < 0) != (f_to < 0)) visit(bracketed(from, to, f_from, f_to));
    } else if (half < 1e-7) {
      visit(middle);
    } else {
      for_each_zero(middle - 0.5 * half, 0.5 * half, visit);
      for_each_zero(middle + 0.5 * half, 0.5 * half, visit);
    }
  }

 private:
  // Regula falsi, Illinois, between ends of opposite signs.
  double bracketed(double from, double to, double f_from, double f_to) const {
    for (int round = 0; round < 60 && std::abs(to - from) > 1e-13; ++round) {
      const double next = to - f_to * (to - from) / (f_to - f_from), f = at(next).value;
      if (f == 0) return next;
      if ((f < 0) == (f_to < 0)) {
        f_from *= 0.5;
      } else {
        from = to;
        f_from = f_to;
      }
      const bool done = std::abs(next - to) < 1e-13;
      to = next;
      f_to = f;
      if (done) break;
    }
    return to;
  }
};

}  // namespace intaglio::contact
