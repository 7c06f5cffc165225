// A relief on a curved base against a textured rectangle: against samples of both fields.
#include <algorithm>
#include <cmath>

#include "contact/curved_body.h"
#include "core/portable_math.h"
#include "mesh/relief_closest.h"
#include "surface/closest.h"
#include "tests/contact/bodies.h"
#include "tests/count_allocations.h"
#include "tests/mesh/curved_bases.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

struct BodyOnFloor {
  std::string name;
  surface::ReliefMesh body;
  std::shared_ptr<const surface::Surface> ground;
};

std::vector<BodyOnFloor> bodies_on_floors() {
  using surface::Edge;
  const auto ball = [](int around, const std::shared_ptr<const surface::Surface>& s) {
    return tests::relief_on(surface::make_sphere(0.1, around, around / 2), s);
  };
  const auto rough = [](int n, double depth, std::uint64_t seed) {
    return tests::rough_surface(n, n, Edge::wrap, 0.1, seed, depth);
  };
  return {{"fine ball, rough floor", ball(48, rough(48, 0.003, 3)), rough(96, 0.01, 4)},
          {"coarse smooth ball, brick floor", ball(16, tests::no_relief()), tests::brick_surface(64)},
          {"rough ball of few triangles, flat floor", ball(12, rough(64, 0.003, 5)), tests::no_relief()}};
}

// The body just above or in the ground: lowered until it touches, then moved by up to `play` metres.
Pose near_ground(Random& random, const BodyOnFloor& pair, double least, double most) {
  Pose pose{Vec3(random.uniform(-0.3, 0.3), 0, random.uniform(-0.2, 0.2)), tests::any_turn(random)};
  double low = 0, high = 0.2;
  for (int k = 0; k < 20; ++k) {
    pose.position.y() = 0.5 * (low + high);
    (curved_on_relief(pair.body, pose, *pair.ground, 0).count > 0 ? low : high) = pose.position.y();
  }
  pose.position.y() = high + random.uniform(least, most);
  return pose;
}

// The least signed distance to the ground of samples of the body, the best improved.
double sampled(const BodyOnFloor& pair, const Pose& pose, int count, Random& random) {
  struct Sampled {
    double gap;
    int triangle;
    Vec3 weights;
  };
  const surface::Surface& ground = *pair.ground;
  const auto distance = [&](int triangle, const Vec3& weights) {
    const Vec3 at = ground.placement().to_local(pose.to_world(pair.body.point(triangle, weights)));
    return closest_point(ground, at)->distance;
  };
  std::vector<Sampled> all;
  for (int k = 0; k < count; ++k) {
    const int triangle = tests::any_triangle(random, pair.body.base());
    const Vec3 weights = tests::any_weights(random);
    const Vec3 at = ground.placement().to_local(pose.to_world(pair.body.point(triangle, weights)));
    all.push_back({at.z() + ground.depth(ground.placement().uv(at)), triangle, weights});
  }
  const auto some = std::min<std::ptrdiff_t>(40, count);
  std::partial_sort(all.begin(), all.begin() + some, all.end(),
                    [](const Sampled& a, const Sampled& b) { return a.gap < b.gap; });
  double best = 1;
  for (std::ptrdiff_t k = 0; k < some; ++k) {
    Sampled& s = all[std::size_t(k)];
    double here = distance(s.triangle, s.weights);
    for (double step = 0.1; step > 1e-6; step *= 0.5) {
      for (int n = 0; n < 8; ++n) {
        const double angle = n * std::numbers::pi / 4;
        const double a = std::clamp(s.weights[1] + step * std::cos(angle), 0.0, 1.0),
                     b = std::clamp(s.weights[2] + step * std::sin(angle), 0.0, 1 - a);
        const double next = distance(s.triangle, {1 - a - b, a, b});
        if (next >= here) continue;
        here = next;
        s.weights = {1 - a - b, a, b};
      }
    }
    best = std::min(best, here);
  }
  return best;
}

}  // namespace

TEST_CASE(
    "a relief ball on a relief floor: no sample is nearer than the first contact, by more than a hair") {
  for (const BodyOnFloor& pair : bodies_on_floors()) {
    Random random(81);
    const double texel = pair.ground->is_flat() ? pair.body.texel_size() : pair.ground->texel_u();
    double worst = 0, mean = 0;
    int within = 0;
    const int count = tests::poses(12, 1000);
    for (int k = 0; k < count; ++k) {
      const Pose pose = near_ground(random, pair, -0.1 * texel, 0.3 * texel);
      const double margin = 0.5 * texel;
      const std::size_t before = allocations();
      const ContactSet set = curved_on_relief(pair.body, pose, *pair.ground, margin);
      CHECK(allocations() == before);
      const double ours = set.count > 0 ? set.points[0].distance : margin,
                   theirs = std::min(margin, sampled(pair, pose, 20000, random));
      within += set.count > 0 ? 1 : 0;
      worst = std::max(worst, (ours - theirs) / texel);
      mean += std::max(0.0, ours - theirs) / texel / count;
      for (const ContactPoint& c : set) {
        CHECK(std::abs(c.normal.norm() - 1) < 1e-9);
        // The body's point is on the body's relief.
        const Vec3 at = pose.to_local(c.point + c.distance * c.normal);
        CHECK(std::abs(closest_point(pair.body, at, 0.1)->distance) < 1e-7);
      }
    }
    MESSAGE(pair.name << ": " << within << " of " << count << " within the margin; a sample nearer by "
                      << worst << " of a texel at most, " << mean << " on the mean");
    CHECK(within > count / 2);
    CHECK(worst < (pair.ground->is_flat() ? 1e-9 : 0.02));
  }
}

TEST_CASE("a relief ball and a floor moved together touch alike; invalid queries get a status") {
  const BodyOnFloor pair = bodies_on_floors()[0];
  Random random(82);
  const Pose by{Vec3(1, 2, -3), tests::any_turn(random)};
  const surface::Placement moved(by.position, by.orientation, pair.ground->placement().size_u(),
                                 pair.ground->placement().size_v());
  const auto there = tests::rough_surface(96, 96, surface::Edge::wrap, 0.1, 4, 0.01);
  surface::Texels texels;
  texels.width = texels.height = 96;
  texels.depth = there->depth_texture();
  texels.normal.assign(96 * 96, Vec3::UnitZ());
  texels.colour = Image8(1, 1, 3);
  const surface::Surface ground(std::move(texels), moved, 0.01, surface::Edge::wrap);
  for (int k = 0; k < 10; ++k) {
    const Pose pose = near_ground(random, pair, -0.001, 0.001);
    const ContactSet a = curved_on_relief(pair.body, pose, *pair.ground, 0.004),
                     b = curved_on_relief(pair.body,
                                          {by.to_world(pose.position), by.orientation * pose.orientation},
                                          ground, 0.004);
    REQUIRE(a.count == b.count);
    for (std::size_t n = 0; n < a.count; ++n) {
      CHECK(a.points[n].distance == doctest::Approx(b.points[n].distance).epsilon(1e-6));
      CHECK((by.orientation * a.points[n].normal - b.points[n].normal).norm() < 1e-5);
    }
  }
  const double nan = std::nan("");
  const auto status_at = [&](const Vec3& at, double margin) {
    return curved_on_relief(pair.body, {at, Quat::Identity()}, *pair.ground, margin).status;
  };
  CHECK(status_at({nan, 0, 0}, 0.001) == status::bad_pose);
  CHECK(status_at({1e7, 0, 0}, 0.001) == status::far);
  CHECK(status_at({5, 0, 0}, 0.001) == status::off_edge);
  CHECK(status_at({0, 5, 0}, 0.001) == status::ok);
  CHECK(status_at({0, -5, 0}, 0.001) == status::under);
  CHECK((status_at({0, 5, 0}, nan) & status::wide_margin) != 0);
  CHECK(curved_on_relief(pair.body, {Vec3::Zero(), Quat(0, 0, 0, 0)}, *pair.ground, 0).status ==
        status::bad_pose);
}

TEST_CASE(
    "a ground of finite thickness has the same contacts except those behind it, and none from its back") {
  for (const BodyOnFloor& pair : bodies_on_floors()) {
    Random random(83);
    const double texel = pair.ground->is_flat() ? pair.body.texel_size() : pair.ground->texel_u();
    const double thickness = 2 * texel, margin = 0.3 * texel;
    int same = 0, behind = 0;
    for (int k = 0; k < tests::poses(20, 500); ++k) {
      Pose pose = near_ground(random, pair, -texel, 0.2 * texel);
      const ContactSet whole = curved_on_relief(pair.body, pose, *pair.ground, margin);
      const ContactSet thick = curved_on_relief(pair.body, pose, *pair.ground, margin, thickness);
      const bool is_shallow = whole.count > 0 && whole.points[0].distance > -thickness;
      if (is_shallow) {
        ++same;
        REQUIRE(thick.count > 0);
        CHECK(thick.points[0].distance == whole.points[0].distance);
        CHECK((thick.points[0].point - whole.points[0].point).norm() == 0);
      }
      for (const ContactPoint& c : thick) CHECK(c.distance >= -thickness);
      // Wholly below the back.
      pose.position.y() = -0.1 - pair.ground->max_depth() - 1.5 * thickness - random.uniform(0.02, 0.1);
      const ContactSet none = curved_on_relief(pair.body, pose, *pair.ground, margin, thickness);
      CHECK(none.count == 0);
      CHECK((none.status & status::under) == 0);
      ++behind;
    }
    CHECK(same > behind / 3);
  }
}
