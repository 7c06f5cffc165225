#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "core/portable_math.h"
#include "surface/closest_bounds.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

template <class T>
Slabs<T> random_pieces(Random& random) {
  const double size = std::pow(10.0, random.uniform(-4, 0));
  const auto four = [&](double low, double high) {
    Four<T> out;
    for (int k = 0; k < 4; ++k) out[k] = T(random.uniform(low, high));
    return out;
  };
  // Up to a step of the full depth over one texel.
  const auto steep = [&] { return Four<T>(four(-1, 1) * T(std::pow(10.0, random.uniform(-1, 2)))); };
  return {four(-3 * size, 3 * size),
          four(-3 * size, 3 * size),
          four(-3 * size, 3 * size),
          steep(),
          steep(),
          four(0, 0.3 * size),
          T(size),
          T(size * random.uniform(0.2, 2))};
}

// A point of slab k.
template <class T>
Vec3 random_point(const Slabs<T>& p, int k, Random& random) {
  const double edge = random.uniform() < 0.3 ? 0.5 : random.uniform(0, 0.5);
  const double x = (random.uniform() < 0.5 ? edge : -edge) * double(p.w),
               y = random.uniform(-0.5, 0.5) * double(p.h);
  return {double(p.x[k]) + x, double(p.y[k]) + y,
          double(p.z[k]) + double(p.slope_x[k]) * x + double(p.slope_y[k]) * y +
              random.uniform(-1, 1) * double(p.half_thickness[k])};
}

template <class T>
void check_bounds() {
  Random random(5);
  double sharpest = 0;
  int held = 0, wrong = 0;
  for (int n = 0; n < 3000; ++n) {
    const Slabs<T> pieces = random_pieces<T>(random);
    const Boxes<T> boxes = pieces.boxes();
    const Four<T> box2 = boxes.min_distance2(), plane2 = pieces.min_distance2();
    const T reach = T(random.uniform(0.5, 4)) * pieces.w;
    const ClippedBoxes<T> reached(boxes, reach);
    const Vec3 axis = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    const double cosine = std::cos(random.uniform(0.1, 1.5));
    const unsigned box_in = reached.boxes_in_cone(axis, cosine),
                   plane_in = reached.planes_in_cone(pieces, axis, cosine);
    for (int k = 0; k < 4; ++k) {
      double nearest2 = 1e9;
      for (int m = 0; m < 60; ++m) {
        const Vec3 at = random_point(pieces, k, random);
        nearest2 = std::min(nearest2, at.squaredNorm());
        const bool wanted = at.norm() < double(reach) && !(at.dot(axis) > cosine * at.norm());
        wrong += int(wanted && ((box_in | plane_in) >> k & 1u) != 0);
      }
      wrong += int(double(box2[k]) > nearest2) + int(double(plane2[k]) > nearest2);
      sharpest = std::max(sharpest, double(plane2[k]) / nearest2);
      held += int(box_in >> k & 1u) + int(plane_in >> k & 1u);
    }
  }
  CHECK(wrong == 0);
  CHECK(sharpest > 0.9);  // bounds that are always 0 would pass the rest
  CHECK(held > 1000);
}

}  // namespace

TEST_CASE("bounds of four slabs hold for every point of them, in both precisions") {
  SUBCASE("single") {
    check_bounds<float>();
  }
  SUBCASE("double") {
    check_bounds<double>();
  }
}

TEST_CASE("where a slab is called monotonic, the distance is monotonic across it and around it") {
  Random random(6);
  int claimed = 0;
  for (int n = 0; n < 3000; ++n) {
    const Slabs<double> p = random_pieces<double>(random);
    const Four<double> none = Four<double>::Zero();
    Slabs<double> flat = p;  // a plane, whose slopes are known exactly
    flat.half_thickness = none;
    const unsigned without = flat.monotonic(none, none);
    for (int k = 0; k < 4; ++k) {
      if ((without >> k & 1u) == 0) continue;
      ++claimed;
      // The derivative of half the squared distance along x or y keeps its sign up to a quarter side outside.
      std::array<bool, 2> rises{true, true}, falls{true, true};
      for (int m = 0; m < 64; ++m) {
        const double x = random.uniform(-0.75, 0.75) * p.w, y = random.uniform(-0.75, 0.75) * p.h;
        const double z = p.z[k] + p.slope_x[k] * x + p.slope_y[k] * y;
        const std::array<double, 2> slope = {p.x[k] + x + z * p.slope_x[k], p.y[k] + y + z * p.slope_y[k]};
        for (std::size_t axis = 0; axis < 2; ++axis) {
          rises[axis] = rises[axis] && slope[axis] > 0;
          falls[axis] = falls[axis] && slope[axis] < 0;
        }
      }
      CHECK((rises[0] || falls[0] || rises[1] || falls[1]));
    }
  }
  CHECK(claimed > 1000);
}
