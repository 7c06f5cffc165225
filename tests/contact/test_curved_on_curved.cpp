// Two reliefs on curved bases: against samples of both fields.
#include <algorithm>
#include <cmath>

#include "contact/curved_body.h"
#include "core/portable_math.h"
#include "mesh/relief_closest.h"
#include "tests/contact/bodies.h"
#include "tests/count_allocations.h"
#include "tests/mesh/curved_bases.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

struct CurvedPair {
  std::string name;
  surface::ReliefMesh body, ground;
  double from, to;  // m, the body's height: just touching is between
};

std::vector<CurvedPair> curved_pairs() {
  const auto rough = [](int n, double depth, std::uint64_t seed) {
    return tests::rough_surface(n, n, surface::Edge::wrap, 0.1, seed, depth);
  };
  const auto ball = [](double radius, const std::shared_ptr<const surface::Surface>& s) {
    return tests::relief_on(surface::make_sphere(radius, 32, 16), s);
  };
  const auto bowl = tests::relief_on(surface::make_bowl(0.4, 48, 24), rough(96, 0.008, 4));
  return {{"rough ball in a rough bowl", ball(0.1, rough(48, 0.003, 3)), bowl, -0.34, -0.1},
          {"smooth ball in a rough bowl", ball(0.1, tests::no_relief()), bowl, -0.34, -0.1},
          {"rough ball on a rough ball", ball(0.1, rough(48, 0.003, 3)), ball(0.2, rough(64, 0.005, 5)), 0.26,
           0.4}};
}

// Lowered until it touches, then moved by up to `most`.
Pose touching(Random& random, const CurvedPair& pair, double least, double most) {
  Pose pose{Vec3(random.uniform(-0.03, 0.03), 0, random.uniform(-0.03, 0.03)), tests::any_turn(random)};
  double low = pair.from, high = pair.to;
  for (int k = 0; k < 16; ++k) {
    pose.position.y() = 0.5 * (low + high);
    const bool meets = curved_on_curved(pair.body, pose, pair.ground, 0, 0.05).count > 0;
    (meets ? low : high) = pose.position.y();
  }
  pose.position.y() = high + random.uniform(least, most);
  return pose;
}

// The least signed distance to the ground of samples of the body.
double sampled(const CurvedPair& pair, const Pose& pose, int count, Random& random) {
  double best = 1;
  for (int k = 0; k < count; ++k) {
    const int triangle = tests::any_triangle(random, pair.body.base());
    Vec3 weights = tests::any_weights(random);
    const auto distance = [&](const Vec3& w) {
      const auto f = closest_point(pair.ground, pose.to_world(pair.body.point(triangle, w)), 0.02);
      return f ? f->distance : 1.0;
    };
    double here = distance(weights);
    if (here > best + 0.003) continue;
    for (double step = 0.1; step > 1e-5; step *= 0.5) {
      for (int n = 0; n < 8; ++n) {
        const double angle = n * 0.785398, a = std::clamp(weights[1] + step * std::cos(angle), 0.0, 1.0),
                     b = std::clamp(weights[2] + step * std::sin(angle), 0.0, 1 - a);
        const double next = distance({1 - a - b, a, b});
        if (next >= here) continue;
        here = next;
        weights = {1 - a - b, a, b};
      }
    }
    best = std::min(best, here);
  }
  return best;
}

}  // namespace

TEST_CASE("two curved reliefs: no sample is nearer than the first contact, within a tolerance" *
          doctest::test_suite("statistics")) {
  for (const CurvedPair& pair : curved_pairs()) {
    Random random(91);
    const double texel = pair.ground.texel_size(), margin = 0.3 * texel;
    double worst = 0;
    int within = 0;
    const int count = tests::poses(3, 200);
    for (int k = 0; k < count; ++k) {
      const Pose pose = touching(random, pair, -0.1 * texel, 0.2 * texel);
      const std::size_t before = allocations();
      const ContactSet set = curved_on_curved(pair.body, pose, pair.ground, margin, 0.03);
      CHECK(allocations() == before);
      const double ours = set.count > 0 ? set.points[0].distance : margin;
      worst = std::max(worst, (ours - std::min(margin, sampled(pair, pose, 600, random))) / texel);
      within += set.count > 0 ? 1 : 0;
      for (const ContactPoint& c : set) {
        CHECK(std::abs(c.normal.norm() - 1) < 1e-9);
        // The point named by uv is on both.
        CHECK(std::abs(closest_point(pair.ground, c.point, 0.1)->distance) < 1e-7);
        const Vec3 at = pose.to_local(c.point + c.distance * c.normal);
        CHECK(std::abs(closest_point(pair.body, at, 0.1)->distance) < 1e-7);
      }
    }
    MESSAGE(pair.name << ": " << within << " of " << count << " within the margin; a sample nearer by "
                      << worst << " of a texel at most");
    CHECK(within > count / 2);
    CHECK(worst < 0.02);
  }
}

TEST_CASE("invalid queries of two curved reliefs get a status") {
  const CurvedPair pair = curved_pairs()[2];
  const auto status_at = [&](const Vec3& at, double margin) {
    return curved_on_curved(pair.body, {at, Quat::Identity()}, pair.ground, margin, 0.01).status;
  };
  CHECK(status_at({std::nan(""), 0, 0}, 0.001) == status::bad_pose);
  CHECK(status_at({1e7, 0, 0}, 0.001) == status::far);
  CHECK(status_at({0, 5, 0}, 0.001) == status::ok);
  CHECK((status_at({0, 5, 0}, std::nan("")) & status::wide_margin) != 0);
}
