#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "contact/relief_relief.h"
#include "core/portable_math.h"
#include "surface/closest.h"
#include "tests/contact/bodies.h"
#include "tests/count_allocations.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

// Face down at the owner's origin: its relief is below it.
surface::Placement face_down(double side) {
  return {Vec3::Zero(), Quat(Eigen::AngleAxisd(3.14159265358979323846, Vec3::UnitX())), side, side};
}

// Ridges along v: a triangle wave of `waves` in u, 1 cm deep.
std::shared_ptr<const surface::Surface> grating(const surface::Placement& placement, int waves, int n = 64) {
  return tests::made_surface(
      n,
      [&](Vec2 uv) {
        const double phase = uv.x() * waves - std::floor(uv.x() * waves);
        return std::abs(2 * phase - 1);
      },
      [](Vec2) { return Vec3::UnitZ(); }, 0.01, placement, surface::Edge::clamp);
}

// The least distance of points of `one`, a few in each cell, from the patches of the other, by trying all.
double brute(const PosedSurface& one, const PosedSurface& other, double least) {
  const surface::Surface &a = one.surface, &b = other.surface;
  constexpr int fine = 4;
  for (int k = 0; k <= fine * (a.height() - 1); ++k) {
    for (int l = 0; l <= fine * (a.width() - 1); ++l) {
      const int i = std::min(l / fine, a.width() - 2), j = std::min(k / fine, a.height() - 2);
      const Vec3 local = a.cell(i, j).at(double(l) / fine - i, double(k) / fine - j);
      const Vec3 at =
          b.placement().to_local(other.pose.to_local(one.pose.to_world(a.placement().to_world(local))));
      for (int m = 0; m + 1 < b.height(); ++m) {
        for (int n = 0; n + 1 < b.width(); ++n) {
          const surface::Cell cell = b.cell(n, m);
          const Vec3 low(cell.x0, cell.y0, cell.min_z()), high(cell.x1, cell.y1, cell.max_z());
          if ((at - at.cwiseMax(low).cwiseMin(high)).norm() >= least) continue;
          const Vec2 st = tests::closest_on_cell(cell, at);
          least = std::min(least, (at - cell.at(st.x(), st.y())).norm());
        }
      }
    }
  }
  return least;
}

}  // namespace

TEST_CASE("two reliefs: no pair of points is nearer than the first contact") {
  const auto ground = tests::rough_surface(24, 20, surface::Edge::clamp, 0.3, 3);
  const auto body = tests::made_surface(
      14,
      [](Vec2 uv) {
        return 0.5 + 0.3 * std::sin(9 * uv.x()) * std::cos(7 * uv.y()) + 0.1 * std::sin(40 * uv.x() * uv.y());
      },
      [](Vec2) { return Vec3::UnitZ(); }, 0.02, face_down(0.25), surface::Edge::clamp);
  Random random(51);
  int apart = 0, nearer = 0;
  double worst = 0;
  const double margin = 0.004;
  for (int k = 0; k < tests::poses(40, 2000); ++k) {
    Pose pose{
        Vec3(random.uniform(-0.2, 0.2), 0, random.uniform(-0.15, 0.15)),
        Quat(1, random.uniform(-0.1, 0.1), random.uniform(-1, 1), random.uniform(-0.1, 0.1)).normalized()};
    const PosedSurface floor{*ground, {}};
    double low = -0.1, high = 0.2;
    for (int n = 0; n < 30; ++n) {
      pose.position.y() = 0.5 * (low + high);
      (relief_relief_contacts({*body, pose}, floor, 0).count > 0 ? low : high) = pose.position.y();
    }
    pose.position.y() = high + random.uniform(0, 0.006);
    const double ours = tests::first_distance(relief_relief_contacts({*body, pose}, floor, margin), margin);
    const double theirs = brute({*body, pose}, floor, brute(floor, {*body, pose}, margin));
    apart += theirs < margin ? 1 : 0;
    // Contacts are points of both reliefs: never nearer than these are.
    nearer += theirs < ours - 1e-7 ? 1 : 0;
    worst = std::max(worst, ours - theirs);
  }
  MESSAGE(apart << " apart, a sample nearer than the first contact in " << nearer << ", by " << worst
                << " m at most");
  CHECK(apart > 5);
  CHECK(worst < 1e-7);
}

TEST_CASE("interlocking gratings hold each other along, a flat pair does not") {
  const auto ground = grating(tests::flat_placement(), 16, 128), body = grating(face_down(0.25), 4, 32);
  // Ridges of the body over the grooves of the ground, nearly all the way in.
  const ContactSet set =
      relief_relief_contacts({*body, {Vec3(1.0 / 32, -0.0098, 0), Quat::Identity()}}, {*ground, {}}, 0.001);
  double left = 0, right = 0;
  for (const ContactPoint& c : set) {
    left = std::min(left, c.normal.x());
    right = std::max(right, c.normal.x());
  }
  CHECK(left < -0.2);
  CHECK(right > 0.2);
  const auto flat = [](const surface::Placement& p) {
    return tests::made_surface(
        16, [](Vec2) { return 0.5; }, [](Vec2) { return Vec3::UnitZ(); }, 0.01, p, surface::Edge::clamp);
  };
  const auto flat_ground = flat(tests::flat_placement()), flat_body = flat(face_down(0.25));
  const ContactSet plain = relief_relief_contacts({*flat_body, {Vec3(0.03, -0.0101, 0), Quat::Identity()}},
                                                  {*flat_ground, {}}, 0.001);
  CHECK(plain.count >= 4);
  for (const ContactPoint& c : plain) {
    CHECK(std::abs(c.normal.x()) < 1e-9);
    CHECK(c.distance == doctest::Approx(-0.0001).epsilon(1e-4));
  }
}

TEST_CASE(
    "two reliefs: both moved together, nothing changes; odd questions get a status; nothing allocates") {
  const auto ground = tests::brick_surface(64), body = grating(face_down(0.2), 3, 24);
  Random random(52);
  for (int k = 0; k < 20; ++k) {
    const Pose pose{Vec3(random.uniform(-0.2, 0.2), random.uniform(-0.012, -0.004), 0.1),
                    Quat(1, 0.01, random.uniform(-1, 1), 0).normalized()};
    const Pose by{Vec3(random.uniform(-2, 2), 1, -1), tests::any_turn(random)};
    const std::size_t before = allocations();
    const ContactSet a = relief_relief_contacts({*body, pose}, {*ground, {}}, 0.001);
    const ContactSet b = relief_relief_contacts(
        {*body, {by.to_world(pose.position), by.orientation * pose.orientation}}, {*ground, by}, 0.001);
    CHECK(allocations() == before);
    CHECK(a.count == b.count);
    CHECK(tests::first_distance(a, 1) == doctest::Approx(tests::first_distance(b, 1)).epsilon(1e-9));
    for (const ContactPoint& c : a) CHECK(std::abs(c.normal.norm() - 1) < 1e-9);
  }
  const Pose nowhere{Vec3(std::nan(""), 0, 0), Quat::Identity()}, far{Vec3(1e7, 0, 0), Quat::Identity()};
  CHECK(relief_relief_contacts({*body, nowhere}, {*ground, {}}, 0.001).status == status::bad_pose);
  CHECK(relief_relief_contacts({*body, {}}, {*ground, nowhere}, 0.001).status == status::bad_pose);
  CHECK(relief_relief_contacts({*body, far}, {*ground, {}}, 0.001).status == status::far);
  CHECK(relief_relief_contacts({*body, {Vec3(0, 5, 0), Quat::Identity()}}, {*ground, {}}, 0.001).count == 0);
  CHECK((relief_relief_contacts({*body, {}}, {*ground, {}}, std::nan("")).status & status::wide_margin) != 0);
}
