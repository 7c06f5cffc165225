#include "intaglio/surface/detect.h"

#include <algorithm>
#include <cmath>

namespace intaglio::surface {

namespace {

Field halved(const Field& field) {
  Field half(std::max(1, field.width / 2), std::max(1, field.height / 2));
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      const int x1 = std::min(2 * x + 1, field.width - 1);
      const int y1 = std::min(2 * y + 1, field.height - 1);
      half.at(x, y) =
          0.25f * (field.at(2 * x, 2 * y) + field.at(x1, 2 * y) + field.at(2 * x, y1) + field.at(x1, y1));
    }
  }
  return half;
}

Field flipped_rows(const Field& field) {
  Field out(field.width, field.height);
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) out.at(x, y) = field.at(x, field.height - 1 - y);
  }
  return out;
}

// Moments of pairs (a, b).
struct Moments {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(double x, double y) {
    n += 1;
    a += x;
    b += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  double correlation() const {
    const double var_a = aa - a * a / n;
    const double var_b = bb - b * b / n;
    return var_a > 1e-12 * aa && var_b > 1e-12 * bb && var_a > 0 && var_b > 0
               ? (ab - a * b / n) / std::sqrt(var_a * var_b)
               : 0;
  }
};

struct Agreement {
  double u = 0, v = 0;
  double covariance = 0;  // of both axes, sum of slope products
  double power = 0;       // of the height's slopes, sum of squares
  double score() const { return std::sqrt(0.5 * (u * u + v * v)); }
};

// `side`: texels a tile width, so that slopes are those of a full depth of one side.
Agreement compare(const Slopes& slopes, const Field& height) {
  Moments u, v;
  const double scale = height.width / 2.0;
  // Inner texels only: whether the tile wraps is not known here.
  for (int y = 1; y + 1 < height.height; ++y) {
    for (int x = 1; x + 1 < height.width; ++x) {
      u.add(slopes.x.at(x, y), scale * (height.at(x + 1, y) - height.at(x - 1, y)));
      v.add(slopes.y.at(x, y), scale * (height.at(x, y + 1) - height.at(x, y - 1)));
    }
  }
  Agreement out;
  if (u.n > 8) {
    out.u = u.correlation();
    out.v = v.correlation();
  }
  out.covariance = std::abs(u.ab) + std::abs(v.ab);
  out.power = u.bb + v.bb;
  return out;
}

}  // namespace

Detection detect(const Slopes& slopes, const Field& height) {
  Slopes s = slopes;
  Field h = height;
  Field flipped = flipped_rows(height);
  Agreement best;
  bool rows_differ = false;
  for (int level = 0; level < 4 && std::min(h.width, h.height) >= 16; ++level) {
    const Agreement straight = compare(s, h);
    const Agreement other = compare(s, flipped);
    // Flipping needs clear evidence: symmetric textures correlate both ways.
    if (straight.score() > best.score() && !(rows_differ && straight.score() < best.score() + 0.2)) {
      best = straight;
      rows_differ = false;
    }
    if (other.score() > straight.score() + 0.2 && other.score() > best.score() + (rows_differ ? 0 : 0.2)) {
      best = other;
      rows_differ = true;
    }
    s = {halved(s.x), halved(s.y)};
    h = halved(h);
    flipped = halved(flipped);
  }
  Detection out;
  out.correlation_u = best.u;
  out.correlation_v = best.v;
  out.correlation = best.score();
  out.rows_differ = rows_differ;
  out.implied_depth = best.power > 0 ? best.covariance / best.power : 0;
  // u tells what white means, and v compared with u the sign of green. An axis along which nothing varies
  // tells nothing: then green is taken to be +Y.
  constexpr double tells = 0.1;
  const bool u_tells = std::abs(best.u) > tells;
  const bool v_tells = std::abs(best.v) > tells;
  const double decisive = u_tells ? best.u : best.v;
  out.polarity = decisive >= 0 ? Polarity::height : Polarity::depth;
  out.green = u_tells && v_tells && (best.u >= 0) != (best.v >= 0) ? Green::minus_y : Green::plus_y;
  return out;
}

}  // namespace intaglio::surface
