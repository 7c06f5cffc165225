// Meshes as people have them, each written as a file and baked as the command does it: a model that rings,
// with the known mass, or one line that says why not. Never an empty model, never silence.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "core/portable_math.h"
#include "mesh/mesh_file.h"
#include "sound/bake/bake.h"
#include "sound/bake/fem/fill_surface.h"
#include "sound/model_file.h"
#include "tests/bake/surfaces.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using surface::TriangleMesh;
using test::tau;

namespace {

struct Hard {
  std::string name;
  std::string obj;
  double volume = 0;         // of a body that must ring, m^3, within 3 %; 0: any
  std::string refusal = {};  // the one line must contain this; empty: it must ring
  bool either = false;       // a good model or a reason: both are right
};

std::string as_obj(const TriangleMesh& mesh) {
  std::string text;
  for (const Vec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : mesh.triangles) text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
  return text;
}

TriangleMesh moved(TriangleMesh mesh, const Vec3& by, double scale = 1) {
  for (Vec3& p : mesh.positions) p = scale * p + by;
  return mesh;
}

TriangleMesh inside_out(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

// A grid of u by v points, closed in u, and in v too if asked; `at` gives the place of each.
template <class At>
TriangleMesh wrapped(int u, int v, bool is_closed, At at) {
  std::vector<Vec3> points;
  std::vector<surface::Triangle> faces;
  for (int j = 0; j < v; ++j) {
    for (int i = 0; i < u; ++i) points.push_back(at(double(i) / u, double(j) / (is_closed ? v : v - 1)));
  }
  for (int j = 0; j + !is_closed < v; ++j) {
    for (int i = 0; i < u; ++i) {
      const int a = j * u + i, b = j * u + (i + 1) % u, c = (j + 1) % v * u + (i + 1) % u,
                d = (j + 1) % v * u + i;
      faces.push_back({a, c, b});
      faces.push_back({a, d, c});
    }
  }
  return test::mesh_of(std::move(points), std::move(faces));
}

TriangleMesh torus(double around, double thick) {
  return wrapped(48, 24, true, [=](double u, double v) {
    const double r = around + thick * std::cos(tau * v);
    return Vec3(r * std::cos(tau * u), thick * std::sin(tau * v), r * std::sin(tau * u));
  });
}

// Every triangle with corners of its own, none shared.
TriangleMesh unwelded(const TriangleMesh& mesh, double gap, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> points;
  std::vector<surface::Triangle> faces;
  for (const auto& t : mesh.triangles) {
    const int first = int(points.size());
    for (const int p : t)
      points.emplace_back(mesh.positions[std::size_t(p)] +
                          gap * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
    faces.push_back({first, first + 1, first + 2});
  }
  return test::mesh_of(std::move(points), std::move(faces));
}

TriangleMesh jittered(TriangleMesh mesh, double by) {
  Random random(11);
  for (Vec3& p : mesh.positions)
    p += by * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  return mesh;
}

TriangleMesh spiky(double length) {
  TriangleMesh ball = test::icosphere(0.1, 3);
  for (std::size_t p = 0; p < ball.positions.size(); p += 40) ball.positions[p] *= 1 + length;
  return ball;
}

TriangleMesh soup(int count) {
  Random random(5);
  std::vector<Vec3> points;
  std::vector<surface::Triangle> faces;
  for (int t = 0; t < count; ++t) {
    for (int k = 0; k < 3; ++k)
      points.emplace_back(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
    faces.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return test::mesh_of(std::move(points), std::move(faces));
}

std::vector<Hard> closed_ones() {
  const auto ball = test::icosphere(0.1, 3), cube = test::cuboid({0.2, 0.2, 0.2});
  const double ball_volume = 0.0041472, cube_volume = 0.008;  // of the icosphere itself
  auto mixed = ball;
  for (std::size_t t = 0; t < mixed.triangles.size(); t += 3)
    std::swap(mixed.triangles[t][1], mixed.triangles[t][2]);
  auto slivers = ball;
  for (int t = 0; t < 50; ++t) slivers.triangles.push_back({t, t, t + 1});
  auto doubled = ball;
  doubled.triangles.insert(doubled.triangles.end(), ball.triangles.begin(), ball.triangles.begin() + 100);
  auto unused = ball;
  unused.positions.emplace_back(1e4, 0, 0);
  auto lens = ball;
  for (Vec3& p : lens.positions) p.y() *= 0.1;
  const auto pipe = wrapped(200, 2, false, [](double u, double v) {
    return Vec3(0.02 * std::cos(tau * u), v - 0.5, 0.02 * std::sin(tau * u));
  });
  return {
      {"sphere", as_obj(ball), ball_volume},
      {"thin plate", as_obj(test::cuboid({0.5, 0.01, 0.5})), 0.0025},
      {"bar", as_obj(test::cuboid({1, 0.05, 0.05})), 0.0025},
      {"torus", as_obj(torus(0.1, 0.03)), 0.00173},
      {"lens with a sharp rim", as_obj(lens), 0.1 * ball_volume},
      {"inverted", as_obj(inside_out(ball)), ball_volume},
      {"every third triangle turned", as_obj(mixed), ball_volume},
      {"triangles of no area", as_obj(slivers), ball_volume},
      {"doubled triangles", as_obj(doubled), ball_volume},
      {"an unused vertex far away", as_obj(unused), ball_volume},
      {"unwelded", as_obj(unwelded(ball, 0, 1)), ball_volume},
      {"cracks of a micrometre", as_obj(unwelded(ball, 1e-6, 2)), ball_volume},
      {"cracks of a millimetre", as_obj(unwelded(ball, 1e-3, 3)), 0},
      {"far from the origin", as_obj(moved(ball, Vec3(1000, -2000, 3000))), ball_volume},
      {"self-intersecting by noise", as_obj(jittered(ball, 0.01)), 0},
      {"spikes", as_obj(spiky(0.5)), 0},
      {"long spikes", as_obj(spiky(3)), 0, {}, true},
      {"two shells that overlap", as_obj(test::together(ball, ball, Vec3(0.1, 0, 0))), 0},
      {"a hollow", as_obj(test::together(ball, inside_out(test::icosphere(0.05, 3)), Vec3::Zero())),
       ball_volume * 0.875},
      {"a shell within a shell, both outward",
       as_obj(test::together(ball, test::icosphere(0.05, 3), Vec3::Zero())), ball_volume},
      {"cubes that share a wall", as_obj(test::together(cube, cube, Vec3(0.2, 0, 0))), 2 * cube_volume},
      {"a pipe open at its ends", as_obj(pipe), 0, {}, true},
  };
}

std::vector<Hard> broken_ones() {
  const auto ball = test::icosphere(0.1, 3), cube = test::cuboid({0.2, 0.2, 0.2});
  auto holes = ball;
  for (std::size_t k = 0; k < 10; ++k)
    holes.triangles.erase(holes.triangles.begin() + std::ptrdiff_t(100 * k));
  auto bowl = ball;
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.positions[std::size_t(t[0])].y() > 0; });
  auto lid = cube;
  lid.triangles.pop_back();
  // Half a twist: one side only.
  std::vector<Vec3> band;
  std::vector<surface::Triangle> strip;
  for (int i = 0; i < 40; ++i) {
    const double a = tau * i / 40;
    for (const double w : {-0.02, 0.02})
      band.emplace_back((0.1 + w * std::cos(a / 2)) * std::cos(a), w * std::sin(a / 2),
                        (0.1 + w * std::cos(a / 2)) * std::sin(a));
    const int p = 2 * i, q = i == 39 ? 1 : p + 2, r = i == 39 ? 0 : p + 3;
    strip.push_back({p, q, p + 1});
    strip.push_back({q, r, p + 1});
  }
  const auto klein = wrapped(60, 24, true, [](double u, double v) {
    const double a = tau * u, b = tau * v,
                 r = 0.1 + 0.04 * (std::cos(a / 2) * std::sin(b) - std::sin(a / 2) * std::sin(2 * b));
    return Vec3(r * std::cos(a), 0.04 * (std::sin(a / 2) * std::sin(b) + std::cos(a / 2) * std::sin(2 * b)),
                r * std::sin(a));
  });
  return {
      {"ten holes", as_obj(holes), 0.0041472},
      {"a cube without a triangle", as_obj(lid), 0, {}, true},
      {"half a ball, open", as_obj(bowl), 0, "open"},
      {"a sheet", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n", 0, "volume"},
      {"a bent sheet", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 .4\nf 1 2 3\nf 2 4 3\n", 0, "volume|open"},
      {"Moebius strip", as_obj(test::mesh_of(band, strip)), 0, "volume|open"},
      {"Klein bottle", as_obj(klein), 0, {}, true},
      {"two shells apart", as_obj(test::together(ball, ball, Vec3(0.5, 0, 0))), 0, "2 disconnected parts"},
      {"cubes that share an edge", as_obj(test::together(cube, cube, Vec3(0.2, 0.2, 0))), 0,
       "disconnected parts", true},
      {"cubes that share a corner", as_obj(test::together(cube, cube, Vec3(0.2, 0.2, 0.2))), 0,
       "disconnected parts", true},
      {"random triangles", as_obj(soup(200)), 0, {}, true},
      {"only triangles of no area", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n", 0, "area|volume"},
      {"no triangles", "v 0 0 0\nv 1 0 0\n", 0, "no "},
      {"an empty file", "", 0, "no "},
      {"not a number", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 0, "nan|finite|number"},
      {"a vertex that is not there", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", 0, "missing position"},
      {"paper", as_obj(test::cuboid({1, 1, 0.0002})), 0, "thick"},
      {"a grain of dust", as_obj(moved(ball, Vec3::Zero(), 1e-4)), 0, "mode"},
  };
}

struct Outcome {
  std::optional<ModalModel> model;
  std::string error;
};

Outcome bake_file(const Hard& hard, int elements) {
  const std::string name = "hard.obj";
  const auto mesh = surface::parse_obj(hard.obj, name, surface::MeshUse::shape);
  if (!mesh) return {{}, mesh.error().message()};
  const auto body = body_surface(*mesh, name);
  if (!body) return {{}, body.error().message()};
  const ModeOptions modes{10, 20, 20'000};
  const auto filled =
      fill_surface(*body, {element_size(body->volume, body->area, test::steel(), modes), elements}, name);
  if (!filled) return {{}, filled.error().message()};
  auto model = bake(filled->mesh, test::steel(), {name, modes});
  if (!model) return {{}, name + ": " + model.error().message()};
  if (model->modes() == 0) return {{}, name + ": no mode"};  // as the command says
  return {std::move(*model), {}};
}

bool says_one_of(const std::string& text, std::string words) {
  for (std::size_t bar; !words.empty(); words = bar == std::string::npos ? "" : words.substr(bar + 1)) {
    bar = words.find('|');
    if (text.find(words.substr(0, bar)) != std::string::npos) return true;
  }
  return false;
}

void check(const Hard& hard, int elements) {
  INFO(hard.name);
  const Outcome outcome = bake_file(hard, elements);
  if (!outcome.model) {
    MESSAGE(hard.name << ": refused: " << outcome.error);
    CHECK(outcome.error.starts_with("hard.obj"));
    CHECK(outcome.error.find('\n') == std::string::npos);
    CHECK((hard.either || !hard.refusal.empty()));
    if (!hard.refusal.empty()) CHECK(says_one_of(outcome.error, hard.refusal));
    return;
  }
  const ModalModel& model = *outcome.model;
  MESSAGE(fmt::format("{}: {} modes from {:.1f} Hz, {:.3g} kg", hard.name, model.modes(),
                      model.angular_frequency[0] / tau, model.mass));
  CHECK((hard.either || hard.refusal.empty()));
  if (hard.volume > 0) CHECK(model.mass == doctest::Approx(7850 * hard.volume).epsilon(0.03));
  CHECK(model.modes() > 0);
  for (int m = 0; m < model.modes(); ++m) {
    double largest = 0;
    for (std::size_t p = 0; p < model.points.size(); ++p)
      largest = std::max(largest, model.shape(int(p), m).norm());
    CHECK(largest > 0);  // no mode is silent
    CHECK(std::isfinite(largest));
  }
  CHECK(parse_model(model_bytes(model), "hard.modes"));
}

}  // namespace

TEST_CASE("difficult meshes with an inside ring" * doctest::test_suite("statistics")) {
  const auto all = closed_ones();
  for (const Hard& hard : all) check(hard, 10'000);
}

TEST_CASE("broken meshes ring or give a reason") {
  const auto all = broken_ones();
  for (const Hard& hard : all) check(hard, 10'000);
}

TEST_CASE("a million triangles") {
  // 80,000 always; 1.3 million if there is time.
  const auto ball = test::icosphere(0.1, std::getenv("INTAGLIO_SLOW") ? 8 : 6);
  auto rough = jittered(ball, 1e-5);
  check({"many triangles", as_obj(ball), 0.0041888}, 3000);
  // However many triangles there are, the pitch is Lamb's.
  const Outcome baked = bake_file({"many triangles", as_obj(ball)}, 3000);
  REQUIRE(baked.model);
  const double unit = std::sqrt(test::steel().shear_modulus() / 7850) / (tau * 0.1);
  for (const int m : {0, 5})
    CHECK(baked.model->angular_frequency[std::size_t(m)] / tau / unit ==
          doctest::Approx(m == 0 ? 2.50113 : 2.64622).epsilon(0.003));
  if (std::getenv("INTAGLIO_SLOW")) check({"many rough triangles", as_obj(rough), 0.0041888}, 3000);
}
