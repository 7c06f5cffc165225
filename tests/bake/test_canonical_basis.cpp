// The sound of modes of equal frequency does not depend on which rotation of them a solver returns.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <Eigen/QR>
#include <cmath>
#include <numeric>

#include "sound/bake/bake.h"
#include "sound/bake/fem/fill_surface.h"
#include "sound/bake/fem/modes.h"
#include "sound/bake/merge_modes.h"
#include "sound/bake/radiation.h"
#include "sound/modal_model.h"
#include "sound/strike.h"
#include "tests/bake/surfaces.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using Eigen::Index;
using Eigen::MatrixXd;
using test::tau;

namespace {

MatrixXd any_rotation(Index size, Random& random) {
  const MatrixXd gauss = MatrixXd::NullaryExpr(size, size, [&] { return random.normal(); });
  return Eigen::HouseholderQR<MatrixXd>(gauss).householderQ();
}

std::vector<Index> groups_of(const Modes& modes) {
  return frequency_groups({modes.angular_frequency.data(), std::size_t(modes.angular_frequency.size())});
}

// A regular prism about Y, filled by the lattice.
TetMesh prism(int sides) {
  surface::TriangleMesh surface;
  const double radius = 0.05, half = 0.075;
  const auto corner = [&](int k, double y) {
    const double turn = tau * k / sides;
    return Vec3(radius * std::cos(turn), y, -radius * std::sin(turn));
  };
  for (const double y : {-half, half}) {
    for (int k = 0; k < sides; ++k) surface.positions.push_back(corner(k, y));
  }
  for (int k = 0; k < sides; ++k) {
    const int next = (k + 1) % sides;
    surface.triangles.push_back({k, next, next + sides});
    surface.triangles.push_back({k, next + sides, k + sides});
  }
  for (int k = 1; k + 1 < sides; ++k) {
    surface.triangles.push_back({0, k + 1, k});
    surface.triangles.push_back({sides, sides + k, sides + k + 1});
  }
  return test::fill_surface(surface, {0.02, 20'000}, "prism").value().mesh;
}

struct Body {
  std::string name;
  TetMesh mesh;
  Material material;
};

std::vector<Body> bodies() {
  const Material ceramic = *find_material("ceramic"), glass = *find_material("glass");
  std::vector<Body> all{{"ball", ball(0.15, 1), ceramic},
                        {"plate", box({0.3, 0.01, 0.3}, 10, 1, 10), ceramic},
                        {"cube", box({0.1, 0.1, 0.1}, 4, 4, 4), test::steel()},
                        {"cylinder", cylinder(0.03, 0.2, 2, 8), test::steel()}};
  for (const int sides : {3, 4, 5, 6, 7, 8})
    all.push_back({fmt::format("prism of {} sides", sides), prism(sides), glass});
  return all;
}

// How two recordings differ, over the first, in dB; and their levels.
struct Difference {
  double difference_db = -400, level_db = 0;
};
Difference compare(const std::vector<float>& a, const std::vector<float>& b) {
  double power = 0, other = 0, difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    power += std::pow(double(a[k]), 2);
    other += std::pow(double(b[k]), 2);
    difference += std::pow(double(a[k]) - double(b[k]), 2);
  }
  REQUIRE(power > 0);
  REQUIRE(std::isfinite(difference + other));
  return {10 * std::log10(difference / power + 1e-40), std::abs(10 * std::log10(other / power))};
}

// The worst difference, struck at the default point and at some others in any direction.
Difference compare_struck(const ModalModel& a, const ModalModel& b, Random& random) {
  Difference worst;
  const Vec3 place = default_strike_point(a);
  for (int blow = 0; blow < 4; ++blow) {
    const Vec3 at = blow == 0 ? place : a.points[std::size_t(random.uniform(0, double(a.points.size()) - 1))];
    const Vec3 direction = blow == 0 ? -nearest_surface(a, at).normal : test::any_direction(random);
    const Difference d =
        compare(test::struck_at(a, at, direction, 8192), test::struck_at(b, at, direction, 8192));
    worst = {std::max(worst.difference_db, d.difference_db), std::max(worst.level_db, d.level_db)};
  }
  return worst;
}

// The model with the radiation of its own surface, which was more accurate before it was sampled.
ModalModel as_sampled(ModalModel model) {
  model.radiation = mode_radiation(model, volume_velocity(model));
  return model;
}

// A model with its shapes rotated within each group of equal frequency, and its radiation computed for them.
ModalModel turned(const ModalModel& model, Random& random) {
  ModalModel out = model;
  const std::vector<Index> first = frequency_groups(model.angular_frequency);
  Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> shapes(
      out.shapes.data(), Index(3 * model.points.size()), model.modes());
  for (std::size_t g = 0; g + 1 < first.size(); ++g) {
    const Index size = first[g + 1] - first[g];
    shapes.middleCols(first[g], size) =
        (shapes.middleCols(first[g], size).cast<double>() * any_rotation(size, random)).eval().cast<float>();
  }
  return as_sampled(std::move(out));
}

}  // namespace

TEST_CASE("groups of equal frequency are complete") {
  const std::vector<double> omega{1000, 1000 * (1 + 5e-7), 1000 * (1 + 1e-6), 1001, 2000, 2000};
  CHECK(frequency_groups(omega) == std::vector<Index>{0, 3, 4, 6});
  CHECK(frequency_groups({}) == std::vector<Index>{0});
  // Each count that would cut a group brings the rest of it.
  const ElasticSystem system = assemble(box({1, 1, 1}, 4, 4, 4), test::steel());
  const Modes all = *free_modes(system, {24, 20, 20'000});
  const std::vector<Index> first = groups_of(all);
  for (int count = 1; count <= 12; ++count) {
    const Modes some = *free_modes(system, {count, 20, 20'000});
    const Index size = some.angular_frequency.size();
    CHECK(size >= count);
    CHECK(std::find(first.begin(), first.end(), size) != first.end());
    CHECK((some.angular_frequency - all.angular_frequency.head(size)).norm() <
          1e-9 * all.angular_frequency[0]);
    CHECK((some.shape - all.shape.leftCols(size)).norm() < 1e-6 * some.shape.norm());
  }
}

TEST_CASE("struck bodies sound the same in any basis of their modes of equal frequency: -80 dB, 0.01 dB" *
          doctest::test_suite("statistics")) {
  const int rotations = std::getenv("INTAGLIO_SLOW") ? 20 : 2;
  for (const Body& body : bodies()) {
    const double mass = body.material.density * volume(body.mesh);
    const BakeOptions options{body.name, {24, 20, 20'000}};
    const Modes modes = *free_modes(assemble(body.mesh, body.material), options.modes);
    const ModalModel model =
        make_modal_model(modes, boundary_surface(body.mesh), mass, body.material, options).value();
    const ModalModel sampled = as_sampled(model);
    const std::vector<Index> first = groups_of(modes);
    Random random(7);
    Difference raw, baked;
    double basis = 0;
    for (int k = 0; k < rotations; ++k) {
      Modes other = modes;
      for (std::size_t g = 0; g + 1 < first.size(); ++g) {
        const Index size = first[g + 1] - first[g];
        other.shape.middleCols(first[g], size) *= any_rotation(size, random);
      }
      make_canonical(other);
      basis = std::max(basis, (other.shape - modes.shape).norm() / modes.shape.norm());
      const ModalModel again =
          make_modal_model(other, boundary_surface(body.mesh), mass, body.material, options).value();
      const Difference a = compare_struck(model, again, random),
                       b = compare_struck(sampled, turned(model, random), random);
      raw = {std::max(raw.difference_db, a.difference_db), std::max(raw.level_db, a.level_db)};
      baked = {std::max(baked.difference_db, b.difference_db), std::max(baked.level_db, b.level_db)};
    }
    MESSAGE(fmt::format(
        "{:18} {} modes in {} groups: eigenvectors turned {:.0f} dB, {:.5f} dB of level; model turned "
        "{:.0f} dB, {:.5f} dB; basis within {:.1e}",
        body.name, model.modes(), first.size() - 1, raw.difference_db, raw.level_db, baked.difference_db,
        baked.level_db, basis));
    CHECK(raw.difference_db < -80);
    CHECK(raw.level_db < 0.01);
    CHECK(baked.difference_db < -80);
    CHECK(baked.level_db < 0.01);
    CHECK(basis < 1e-9);
  }
}

TEST_CASE("scaling and merging do not depend on the basis either" * doctest::test_suite("statistics")) {
  const ModalModel fine = bake(ball(0.15, 2), *find_material("ceramic"), {"ball", {40, 20, 20'000}}).value();
  for (const ModalModel& baked : {*test::small_ball(), fine}) {
    const ModalModel model = as_sampled(baked);
    Random random(9);
    for (int k = 0; k < 3; ++k) {
      const ModalModel other = turned(model, random);
      CHECK(compare_struck(scaled(model, 1.7), scaled(other, 1.7), random).difference_db < -80);
      ModalModel merged = model, other_merged = other;
      merge_modes(merged, 0.5);
      merge_modes(other_merged, 0.5);
      CHECK(merged.modes() == other_merged.modes());
      const double difference = compare_struck(merged, other_merged, random).difference_db;
      MESSAGE(model.modes() << " modes become " << merged.modes() << ": " << difference << " dB");
      CHECK(difference < -80);
    }
  }
}

TEST_CASE("a rotation among near-equal modes is the less audible the more slowly they beat") {
  // A pair that beats at a thousandth of its decay rate: rotated, it differs by about as much.
  ModalModel pair = *test::small_slab();
  const double d = pair.damping[1];
  for (const double beat : {1e-3, 1e-2}) {
    pair.angular_frequency[2] = pair.angular_frequency[1] + beat * d;
    pair.damping[2] = d;
    pair.radiation = mode_radiation(pair, volume_velocity(pair));
    ModalModel other = pair;
    const double c = std::cos(0.7), s = std::sin(0.7);
    const std::size_t modes = std::size_t(pair.modes());
    for (std::size_t row = 0; row < 3 * pair.points.size(); ++row) {
      const float a = pair.shapes[row * modes + 1], b = pair.shapes[row * modes + 2];
      other.shapes[row * modes + 1] = float(c * a + s * b);
      other.shapes[row * modes + 2] = float(c * b - s * a);
    }
    other.radiation = mode_radiation(other, volume_velocity(other));
    Random random(3);
    const double difference = compare_struck(pair, other, random).difference_db;
    MESSAGE("beat of " << beat << " of the decay rate: " << difference << " dB");
    CHECK(difference < 20 * std::log10(beat) + 6);
  }
}

TEST_CASE("a mode that is alone radiates its root mean square over all directions, as before") {
  const auto slab = test::small_slab();
  const Eigen::MatrixXd kin = coherence(slab->angular_frequency, slab->damping);
  CHECK((kin - kin.transpose()).norm() == 0);
  CHECK(kin.diagonal() == Eigen::VectorXd::Ones(slab->modes()));
  VibratingSurface surface{slab->points, slab->triangles,
                           MatrixXd(Index(slab->triangles.size()), slab->modes())};
  for (Index j = 0; j < surface.velocity.rows(); ++j) {
    const Triangle& t = surface.triangles[std::size_t(j)];
    const auto at = [&](std::size_t k) { return surface.points[std::size_t(t[k])]; };
    const Vec3 n = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (int m = 0; m < slab->modes(); ++m)
      surface.velocity(j, m) = n.dot(slab->shape(t[0], m) + slab->shape(t[1], m) + slab->shape(t[2], m)) / 3;
  }
  const auto alone = radiated_pressure(surface, slab->angular_frequency);
  const auto together = radiated_pressure(surface, slab->angular_frequency, kin);
  int checked = 0;
  for (std::size_t m = 0; m < alone.size(); ++m) {
    if (kin.row(Index(m)).sum() > 1 + 1e-9) continue;
    ++checked;
    CHECK(std::abs(together[m]) == doctest::Approx(alone[m]).epsilon(1e-6));
  }
  CHECK(checked >= 20);
}
