#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/portable_math.h"
#include "tests/contact/bodies.h"
#include "tests/count_allocations.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

using Method = ContactSet (*)(const surface::Surface&, const Shape&, const Pose&, double);
constexpr std::array<Method, 4> methods = {relief_contacts, directional_contacts, normal_map_contacts,
                                           flat_contacts};

std::shared_ptr<const surface::Surface> flat_at(double depth) {
  return tests::made_surface(
      32, [depth](Vec2) { return depth / 0.02; }, [](Vec2) { return Vec3::UnitZ(); }, 0.02);
}

Pose over_middle(Random& random, double height) {
  return {Vec3(random.uniform(-0.25, 0.25), height, random.uniform(-0.25, 0.25)), tests::any_turn(random)};
}

// Lowered until it just touches, by bisection.
Pose settled(const surface::Surface& s, const Shape& shape, Pose pose) {
  double low = -0.15, high = 0.3;
  for (int k = 0; k < 40; ++k) {
    pose.position.y() = 0.5 * (low + high);
    const ContactSet set = relief_contacts(s, shape, pose, 0);
    (set.count > 0 ? low : high) = pose.position.y();
  }
  pose.position.y() = high;
  return pose;
}

double deepest(const ContactSet& set) {
  return set.count > 0 ? set.points[0].distance : std::numeric_limits<double>::infinity();
}

}  // namespace

TEST_CASE("a flat relief gives the flat answer, at any depth and attitude") {
  const auto plane = flat_at(0);
  for (const double depth : {0.0, 0.007}) {
    const auto relief = flat_at(depth);
    for (const tests::Body& body : tests::bodies(0.1)) {
      Random random(41);
      for (int k = 0; k < 60; ++k) {
        Pose pose = over_middle(random, 0.3);
        // Some lie flat, or nearly.
        if (k % 3 == 0) pose.orientation = Quat::Identity();
        if (k % 3 == 1)
          pose.orientation = Quat(1, random.uniform(-1e-4, 1e-4), 0.3, random.uniform(-1e-4, 1e-4));
        pose = settled(*plane, body.shape, pose);
        pose.position.y() += random.uniform(-0.001, 0.002);
        Pose lower = pose;
        lower.position.y() -= double(float(depth / 0.02)) * 0.02;
        const ContactSet flat = flat_contacts(*plane, body.shape, pose, 0.0025),
                         ours = relief_contacts(*relief, body.shape, lower, 0.0025);
        INFO(body.name << " " << k);
        CHECK(deepest(ours) == doctest::Approx(deepest(flat)).epsilon(1e-9));
        CHECK(ours.count == flat.count);
        for (const ContactPoint& c : ours) {
          CHECK((c.normal - Vec3::UnitY()).norm() < 1e-6);
          const bool there = std::any_of(flat.begin(), flat.end(), [&](const ContactPoint& f) {
            return (Vec2(c.point.x(), c.point.z()) - Vec2(f.point.x(), f.point.z())).norm() < 1e-7;
          });
          CHECK(there);
        }
      }
    }
  }
}

TEST_CASE("a placement turned and moved, with the body, gives the same contacts turned and moved") {
  surface::BrickRecipe recipe;
  recipe.size = 64;
  Random random(42);
  const surface::Texels brick = surface::to_texels(surface::make_brick(recipe));
  const auto texels = [&] { return brick; };
  const surface::Surface here(texels(), tests::flat_placement(), 0.02, surface::Edge::wrap);
  for (const tests::Body& body : tests::bodies(0.1)) {
    for (int k = 0; k < 10; ++k) {
      const Pose by{Vec3(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)),
                    tests::any_turn(random)};
      const surface::Surface there(texels(), {by.position, by.orientation, 1, 1}, 0.02, surface::Edge::wrap);
      Pose pose = settled(here, body.shape, over_middle(random, 0));
      pose.position.y() += random.uniform(-0.0005, 0.0005);
      const ContactSet a = relief_contacts(here, body.shape, pose, 0.001),
                       b = relief_contacts(there, body.shape,
                                           {by.to_world(pose.position), by.orientation * pose.orientation},
                                           0.001);
      INFO(body.name << " " << k);
      CHECK(deepest(a) == doctest::Approx(deepest(b)).epsilon(1e-9));
      if (a.count > 0 && b.count > 0 && a.points[0].feature == b.points[0].feature) {
        CHECK((by.to_world(a.points[0].point) - b.points[0].point).norm() < 1e-7);
        CHECK((by.orientation * a.points[0].normal - b.points[0].normal).norm() < 1e-5);
        CHECK((a.points[0].uv - b.points[0].uv).norm() < 1e-7);
      }
    }
  }
}

TEST_CASE("a symmetric body turned onto itself touches alike") {
  const auto s = tests::brick_surface(64);
  const double pi = 3.14159265358979323846;
  const auto about = [](double angle, const Vec3& axis) { return Quat(Eigen::AngleAxisd(angle, axis)); };
  for (const tests::Body& body : tests::bodies(0.1)) {
    std::vector<Quat> symmetries;
    if (body.name == "sphere") symmetries = {about(1, Vec3::UnitX()), about(2, Vec3(1, 2, 3).normalized())};
    if (body.name == "box")
      symmetries = {about(pi, Vec3::UnitX()), about(pi, Vec3::UnitY()), about(pi, Vec3::UnitZ())};
    if (body.name == "capsule" || body.name == "cylinder")
      symmetries = {about(1, Vec3::UnitY()), about(pi, Vec3::UnitX()), about(pi, Vec3::UnitZ())};
    if (body.name == "mesh") symmetries = {about(pi, Vec3(1, 1, 0).normalized())};
    Random random(43);
    for (int k = 0; k < 20; ++k) {
      Pose pose = settled(*s, body.shape, over_middle(random, 0));
      pose.position.y() += random.uniform(-0.0005, 0.0005);
      const double as_is = deepest(relief_contacts(*s, body.shape, pose, 0.001));
      for (const Quat& turn : symmetries) {
        const Pose turned{pose.position, pose.orientation * turn};
        INFO(body.name << " " << k);
        CHECK(deepest(relief_contacts(*s, body.shape, turned, 0.001)) ==
              doctest::Approx(as_is).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("a texture that is shifted cyclically gives shifted contacts") {
  const int n = 48, roll = 11;
  for (const surface::Edge edge : {surface::Edge::wrap, surface::Edge::clamp}) {
    const auto surface_of = [&](int shift) {
      return tests::made_surface(
          n,
          [&](Vec2 uv) {
            const double u = 6.283185307179586 * (std::floor(uv.x() * n) - shift) / n,
                         v = 6.283185307179586 * uv.y();
            return 0.5 + 0.2 * std::sin(3 * u + 1) * std::cos(2 * v) + 0.2 * std::sin(7 * u + 5 * v);
          },
          [](Vec2) { return Vec3::UnitZ(); }, 0.02, tests::flat_placement(), edge);
    };
    const auto here = surface_of(0), there = surface_of(roll);
    const Vec3 step(double(roll) / n, 0, 0);
    for (const tests::Body& body : tests::bodies(0.1)) {
      Random random(44);
      for (int k = 0; k < 20; ++k) {
        Pose pose = settled(*here, body.shape, over_middle(random, 0));
        pose.position.x() -= step.x() / 2;
        pose = settled(*here, body.shape, pose);
        const Pose moved{pose.position + step, pose.orientation};
        const ContactSet a = relief_contacts(*here, body.shape, pose, 0.001),
                         b = relief_contacts(*there, body.shape, moved, 0.001);
        INFO(body.name << " " << k);
        CHECK(a.count == b.count);
        CHECK(std::abs(deepest(a) - deepest(b)) < 1e-8);
      }
    }
  }
}

TEST_CASE("contacts have unit normals, points on the relief, the deepest first, and distinct features") {
  const auto s = tests::brick_surface(128);
  for (const tests::Body& body : tests::bodies(0.1)) {
    Random random(45);
    for (int k = 0; k < 60; ++k) {
      Pose pose = settled(*s, body.shape, over_middle(random, 0));
      pose.position.y() -= random.uniform(-0.0005, 0.0015);
      const ContactSet set = relief_contacts(*s, body.shape, pose, 0.002);
      std::set<std::uint64_t> names;
      for (std::size_t n = 0; n < set.count; ++n) {
        const ContactPoint& c = set.points[n];
        const Vec3 local = s->placement().to_local(c.point);
        INFO(body.name << " " << k);
        CHECK(std::abs(c.normal.norm() - 1) < 1e-12);
        CHECK(c.normal.y() > -1e-9);
        CHECK(c.distance <= 0.002);
        CHECK(std::abs(local.z() + s->depth(s->placement().uv(local))) < 1e-9);
        CHECK((n == 0 || c.distance >= set.points[n - 1].distance));
        names.insert(c.feature);
      }
      CHECK(names.size() == set.count);
    }
  }
}

TEST_CASE("lowered by a little, no body gets deeper by more") {
  const auto s = tests::brick_surface(128);
  for (const tests::Body& body : tests::bodies(0.1)) {
    Random random(46);
    int steps = 0, more = 0;
    double worst = 0;
    for (int k = 0; k < 60; ++k) {
      Pose pose = settled(*s, body.shape, over_middle(random, 0));
      pose.position.y() += 0.001;
      double before = deepest(relief_contacts(*s, body.shape, pose, 0.002));
      for (int n = 0; n < 20; ++n) {
        pose.position.y() -= 0.0001;
        const double now = deepest(relief_contacts(*s, body.shape, pose, 0.002));
        ++steps;
        more += now < before - 0.0001 - 1e-9 ? 1 : 0;
        worst = std::max(worst, before - 0.0001 - now);
        before = now;
      }
    }
    MESSAGE(body.name << ": deeper by more than the step in " << more << " of " << steps
                      << " steps, at worst by " << worst << " m");
    CHECK(more <= steps / 100);
  }
}

TEST_CASE("contacts keep their features while a body creeps") {
  const auto s = tests::brick_surface(128);
  for (const tests::Body& body : tests::bodies(0.1)) {
    Random random(47);
    int kept = 0, all = 0;
    for (int k = 0; k < 20; ++k) {
      Pose pose = settled(*s, body.shape, over_middle(random, 0));
      ContactSet before = relief_contacts(*s, body.shape, pose, 0.0005);
      pose.position += Vec3(1e-6, 0, 1e-6);
      const ContactSet now = relief_contacts(*s, body.shape, pose, 0.0005);
      for (const ContactPoint& c : now) {
        ++all;
        kept += std::any_of(before.begin(), before.end(),
                            [&](const ContactPoint& b) { return b.feature == c.feature; })
                    ? 1
                    : 0;
      }
    }
    INFO(body.name);
    CHECK(kept > 0.95 * all);
  }
}

TEST_CASE("a box that overhangs the edge of the rectangle is held at the edge") {
  const auto s = flat_at(0.01);
  const ContactSet set =
      relief_contacts(*s, Box{Vec3(0.1, 0.05, 0.1)}, {Vec3(0.45, 0.0399, 0), Quat::Identity()}, 0.001);
  double outermost = -1;
  for (const ContactPoint& c : set) outermost = std::max(outermost, c.point.x());
  // The relief's last texels are half a texel inside.
  CHECK(outermost > 0.5 - 1.0 / 32);
  CHECK(deepest(set) == doctest::Approx(-0.0001).epsilon(1e-3));
}

TEST_CASE("no method allocates") {
  const auto s = tests::brick_surface(64);
  for (const tests::Body& body : tests::bodies(0.1)) {
    Random random(48);
    const Pose pose = settled(*s, body.shape, over_middle(random, 0));
    const std::size_t before = allocations();
    for (const Method method : methods) {
      for (const double margin : {0.0, 0.002, 0.05}) method(*s, body.shape, pose, margin);
    }
    CHECK(allocations() == before);
  }
}

TEST_CASE("invalid queries get a status") {
  const auto s = tests::brick_surface(64);
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const Quat upright = Quat::Identity();
  for (const Method method : methods) {
    for (const tests::Body& body : tests::bodies(0.1)) {
      const auto asked = [&](const Vec3& at, const Quat& turn) {
        return method(*s, body.shape, {at, turn}, 0.001);
      };
      for (const ContactSet& set :
           {asked({nan, 0, 0}, upright), asked({0, infinity, 0}, upright),
            asked({0, 0, 0}, Quat(nan, 0, 0, 0)), asked({0, 0, 0}, Quat(0, 0, 0, 0))}) {
        CHECK(set.status == status::bad_pose);
        CHECK(set.count == 0);
      }
      CHECK(asked({1e6, 0, 0}, upright).status == status::far);
      CHECK(asked({0, -1e6, 0}, upright).status == status::far);
      CHECK(asked({0.9, 0, 0}, upright).status == status::off_edge);
      CHECK(asked({0, 3, 0}, upright).status == status::ok);
    }
    for (const Shape& shape : std::vector<Shape>{Sphere{}, Sphere{-1}, Sphere{infinity}, Capsule{0, 1},
                                                 Box{Vec3(1, 0, 1)}, Box{Vec3(nan, 1, 1)}, Cylinder{1, 0},
                                                 ConvexHull{}, Mesh{}, Compound{}, make_compound({})}) {
      const ContactSet set = method(*s, shape, {Vec3::Zero(), upright}, 0.001);
      CHECK((set.status & status::no_size) != 0);
      CHECK(set.count == 0);
    }
    const Compound half_good =
        make_compound({{Sphere{nan}, {}}, {Sphere{0.05}, {}}, {Sphere{0.05}, {Vec3(nan, 0, 0), upright}}});
    const ContactSet set = method(*s, half_good, {Vec3(0, 0.03, 0), upright}, 0.001);
    CHECK((set.status & status::no_size) != 0);
    CHECK((set.status & status::bad_pose) != 0);
    CHECK(set.count > 0);
  }
  for (const tests::Body& body : tests::bodies(0.1)) {
    const ContactSet set = relief_contacts(*s, body.shape, {Vec3(0, -0.15, 0), upright}, 0.001);
    INFO(body.name);
    CHECK(((set.status & (status::under | status::deep)) != 0 || set.count > 0));
    CHECK((relief_contacts(*s, body.shape, {Vec3(0, 0.05, 0), upright}, 1e9).status & status::wide_margin) !=
          0);
  }
}

TEST_CASE("results are finite for any input") {
  const std::vector<std::shared_ptr<const surface::Surface>> surfaces = tests::various_surfaces();
  Random random(49);
  const int count = tests::poses(2000, 100000);
  const std::vector<double> sizes = {1e-4, 0.01, 0.08, 0.08, 0.08, 0.3, 3};
  std::vector<std::vector<tests::Body>> all;
  for (const double size : sizes) all.push_back(tests::bodies(size));
  for (int k = 0; k < count; ++k) {
    const auto& s = surfaces[std::size_t(random.uniform() * double(surfaces.size()))];
    const auto which = std::size_t(random.uniform() * double(sizes.size()));
    const Shape& shape = all[which][std::size_t(random.uniform() * double(all[which].size()))].shape;
    const double far = std::pow(10, random.uniform(-2, k % 5 == 0 ? 6 : -0.3));
    const Pose pose{far * Vec3(random.normal(), 0.3 * random.normal(), random.normal()),
                    tests::any_turn(random)};
    const double margin = std::pow(10, random.uniform(-5, -1.5));
    for (const Method method : methods) {
      if (method == directional_contacts && sizes[which] > 0.2) continue;  // slow there
      const ContactSet set = method(*s, shape, pose, margin);
      CHECK(set.count <= ContactSet::capacity);
      for (const ContactPoint& c : set) {
        CHECK((c.point.allFinite() && c.normal.allFinite() && c.n_s.allFinite() && c.uv.allFinite()));
        CHECK(std::abs(c.normal.norm() - 1) < 1e-9);
        CHECK(c.distance <= margin + 1e-12);
        CHECK(std::isfinite(c.distance));
      }
    }
  }
}
