// Laws that hold for the images of every built-in material.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/hash.h"
#include "core/portable_math.h"
#include "intaglio/material.h"
#include "surface/recipes/builtin.h"
#include "surface/recipes/noise.h"
#include "surface/recipes/painter.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

// Gradient noise as defined, hashing the gradient of every lattice point: the oracle of Fractal.
double periodic_noise(double u, double v, int frequency_u, int frequency_v, std::uint64_t seed) {
  const double x = (u - std::floor(u)) * frequency_u;
  const double y = (v - std::floor(v)) * frequency_v;
  const int i = int(x);
  const int j = int(y);
  const auto gradient = [&](int di, int dj) {
    const double angle =
        2 * std::numbers::pi * lattice_hash((i + di) % frequency_u, (j + dj) % frequency_v, seed);
    const auto [sine, cosine] = elementary::sin_cos(angle);
    return cosine * (x - i - di) + sine * (y - j - dj);
  };
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  const double s = fade(x - i);
  const double t = fade(y - j);
  const double low = gradient(0, 0) + s * (gradient(1, 0) - gradient(0, 0));
  const double high = gradient(0, 1) + s * (gradient(1, 1) - gradient(0, 1));
  return std::numbers::sqrt2 * (low + t * (high - low));
}

double periodic_fractal(double u, double v, int frequency, int octaves, double gain, std::uint64_t seed) {
  double sum = 0;
  double level = 1;
  double total = 0;
  for (int o = 0; o < octaves; ++o) {
    sum += level * periodic_noise(u, v, frequency << o, frequency << o, seed + std::uint64_t(o));
    total += level;
    level *= gain;
  }
  return sum / total;
}

double depth_at(const TextureImages& t, int x, int y) {
  const int n = t.relief.width;
  return t.relief.at((x + n) % n, (y + n) % n, 3) / 65535.0;
}

Vec3 normal_at(const TextureImages& t, int x, int y) {
  Vec3 normal;
  for (int c = 0; c < 3; ++c) normal[c] = t.relief.at(x, y, c) / 32767.5 - 1;
  return normal;
}

using At = std::function<double(const TextureImages&, int, int)>;

double green_at(const TextureImages& t, int x, int y) {
  const int n = t.colour.width;
  return t.colour.at((x + n) % n, (y + n) % n, 1) / 255.0;
}

// Mean square difference between texels k - 1 and k of all rows (or columns).
double step_across(const TextureImages& t, const At& at, int k, bool rows) {
  const int n = t.relief.width;
  double sum = 0;
  for (int j = 0; j < n; ++j) {
    const double d = rows ? at(t, j, k) - at(t, j, k - 1) : at(t, k, j) - at(t, k - 1, j);
    sum += d * d;
  }
  return sum / n;
}

// The step across the seam is no larger than the largest inner one; or, where a steep joint happens to lie on
// the seam, no peak above the steps beside it, as a cut would be.
void check_seam(const TextureImages& texture) {
  for (const At& at : {At(depth_at), At(green_at)}) {
    for (const bool rows : {false, true}) {
      double steepest = 0;
      for (int k = 1; k < 512; ++k) steepest = std::max(steepest, step_across(texture, at, k, rows));
      const double beside = std::max(step_across(texture, at, 1, rows), step_across(texture, at, 511, rows));
      CHECK(step_across(texture, at, 0, rows) <= std::max(1.05 * steepest, 1.6 * beside));
    }
  }
}

// How much depth and colour differ one period on, at most.
double misfit_of_period(const Recipe& recipe) {
  const Painter painter(recipe);
  Random random(1);
  double worst = 0;
  for (int k = 0; k < 5000; ++k) {
    const double u = random.uniform();
    const double v = random.uniform();
    const PaintedPoint here = painter.at(u, v);
    const PaintedPoint there = painter.at(u + 1, v - 1);
    worst = std::max({worst, std::abs(here.depth - there.depth), (here.colour - there.colour).norm()});
  }
  return worst;
}

// The same image at half the size: means over 2 x 2 texels.
std::vector<double> halved(const TextureImages& t) {
  std::vector<double> out;
  for (int y = 0; y < t.relief.height; y += 2) {
    for (int x = 0; x < t.relief.width; x += 2) {
      out.push_back(
          (depth_at(t, x, y) + depth_at(t, x + 1, y) + depth_at(t, x, y + 1) + depth_at(t, x + 1, y + 1)) /
          4);
    }
  }
  return out;
}

double rms_from(const std::vector<double>& expected, const TextureImages& t) {
  double sum = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const int n = t.relief.width;
    const double d = expected[k] - depth_at(t, int(k) % n, int(k) / n);
    sum += d * d;
  }
  return std::sqrt(sum / double(expected.size()));
}

std::uint64_t hash_of(const TextureImages& t) {
  Hash hash;
  for (const std::uint16_t value : t.relief.data) hash.add(value);
  for (const std::uint8_t value : t.colour.data) hash.add(value);
  return hash.value();
}

// Share of texels steeper than about 72 degrees.
double near_vertical(const TextureImages& t) {
  int steep = 0;
  for (int y = 0; y < t.relief.height; ++y) {
    for (int x = 0; x < t.relief.width; ++x) steep += normal_at(t, x, y).z() < 0.3;
  }
  return double(steep) / (t.relief.width * t.relief.height);
}

// Every material with its texture of 512 x 512, made once for all tests.
struct Made {
  Recipe recipe;
  TextureImages texture;
};

const std::vector<Made>& all_made() {
  static const std::vector<Made> all = [] {
    std::vector<Made> made;
    for (const std::string& name : builtin_names()) {
      const Recipe recipe = find_builtin(name).value();
      made.push_back({recipe, make_texture(recipe, 512)});
    }
    return made;
  }();
  return all;
}

}  // namespace

TEST_CASE("the two studies are complete: ten to identify, six to compare, each once") {
  std::vector<int> identification, comparison;
  for (const Made& made : all_made()) {
    const BuiltinMaterial& about = made.recipe.about;
    if (about.study == Study::identification) identification.push_back(about.study_number);
    if (about.study == Study::comparison) comparison.push_back(about.study_number);
    CHECK(find_material(about.material.name).has_value());
    CHECK(about.title != about.name);
    CHECK(about.depth_fraction > 0);
  }
  CHECK(identification == std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
  CHECK(comparison == std::vector<int>{1, 2, 3, 4, 5, 6});
}

TEST_CASE("the materials of the studies have the paper's sound parameters") {
  const auto sounds = [](const char* name) { return find_builtin(name).value().about.material.name; };
  for (const char* name : {"brick_grid", "brick_running", "pebbles"}) CHECK(sounds(name) == "brick");
  for (const char* name : {"porcelain_square", "porcelain_hexagon", "ceramic_tile"})
    CHECK(sounds(name) == "ceramic");
  for (const char* name : {"wood_planks", "wood_grain", "wood_boards", "wood_parquet"})
    CHECK(sounds(name) == "wood");
  for (const char* name : {"stone_flags", "stone_blocks"}) CHECK(sounds(name) == "stone");
}

TEST_CASE("textures are seamless: the wrap is no steeper than the steepest inner steps") {
  for (const Made& made : all_made()) {
    CAPTURE(made.recipe.about.name);
    check_seam(made.texture);
  }
}

TEST_CASE("every pattern is seamless, tilted and warped too") {
  for (const char* pattern :
       {"\"sheet\"", "\"bond\"\ncolumns = 0", "\"bond\"\nstagger = 1\nuneven = [0.5, 0.5]\nsplit = 0.5",
        "\"herringbone\"\ncolumns = 8\nlength = 2", "\"voronoi\"\ncorner = 0.02", "\"scatter\"\nstones = 100",
        "\"lugs\"\ncolumns = 4\nrows = 4", "\"weave\"\ncolumns = 4\nrows = 6"}) {
    CAPTURE(pattern);
    const std::string text =
        std::string("[layout]\nwarp = 0.01\npattern = ") + pattern +
        "\n[profile]\ntilt = 0.5\ncrown = 0.3\n[[layer]]\nalong = \"piece\"\ndepth = 0.1\n";
    const auto recipe = parse_recipe(text, "own.toml");
    REQUIRE_MESSAGE(recipe.has_value(), recipe.error().message());
    CHECK(misfit_of_period(*recipe) < 1e-6);
  }
}

TEST_CASE("the tile repeats exactly: depth and colour have period 1") {
  for (const Made& made : all_made()) {
    CAPTURE(made.recipe.about.name);
    CHECK(misfit_of_period(made.recipe) < 1e-6);
  }
}

TEST_CASE("a seed makes the same texture, another seed another") {
  const auto sampled = [](const Recipe& recipe) {
    const Painter painter(recipe);
    Hash hash;
    for (int k = 0; k < 1000; ++k) {
      const PaintedPoint sample = painter.at(0.001 * k, 0.0377 * k);
      hash.add(sample.depth);
      for (int c = 0; c < 3; ++c) hash.add(sample.colour[c]);
    }
    return hash.value();
  };
  for (const Made& made : all_made()) {
    CAPTURE(made.recipe.about.name);
    Recipe recipe = made.recipe;
    CHECK(sampled(recipe) == sampled(made.recipe));
    recipe.seed += 1;
    CHECK(sampled(recipe) != sampled(made.recipe));
  }
}

TEST_CASE("a texture looks the same at every size" * doctest::test_suite("statistics")) {
  for (const Made& made : all_made()) {
    CAPTURE(made.recipe.about.name);
    CHECK(rms_from(halved(made.texture), make_texture(made.recipe, 256)) < 0.01);
  }
  // 600 and 300 are sampled by different rules: one sample a texel, and four.
  for (const char* name : {"pebbles", "wood_grain", "stone_blocks"}) {
    CAPTURE(name);
    const Recipe recipe = find_builtin(name).value();
    CHECK(rms_from(halved(make_texture(recipe, 600)), make_texture(recipe, 300)) < 0.01);
  }
}

TEST_CASE("small images keep the mean depth" * doctest::test_suite("statistics")) {
  const auto mean = [](const TextureImages& t) {
    double sum = 0;
    for (int y = 0; y < t.relief.height; ++y) {
      for (int x = 0; x < t.relief.width; ++x) sum += depth_at(t, x, y);
    }
    return sum / (t.relief.width * t.relief.height);
  };
  for (const Made& made : all_made()) {
    CAPTURE(made.recipe.about.name);
    const TextureImages small = make_texture(made.recipe, 97);
    CHECK(small.relief.width == 97);
    CHECK(small.colour.height == 97);
    CHECK(mean(small) == doctest::Approx(mean(made.texture)).epsilon(0.02));
  }
}

TEST_CASE("normals are unit, point up and follow from the depth") {
  for (const Made& made : all_made()) {
    CAPTURE(made.recipe.about.name);
    const double slope = made.recipe.about.depth_fraction * 512 / 2;
    double worst = 0, longest = 0, least_z = 1;
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) {
        const Vec3 normal = normal_at(made.texture, x, y);
        // The image's row 0 is the top: v grows against y. Height is minus depth.
        const double dz_du = -(depth_at(made.texture, x + 1, y) - depth_at(made.texture, x - 1, y)) * slope;
        const double dz_dv = -(depth_at(made.texture, x, y - 1) - depth_at(made.texture, x, y + 1)) * slope;
        worst = std::max(worst, (normal - Vec3(-dz_du, -dz_dv, 1).normalized()).norm());
        longest = std::max(longest, std::abs(normal.norm() - 1));
        least_z = std::min(least_z, normal.z());
      }
    }
    CHECK(worst < 1e-3);  // depth is rounded to 16 bits, and times a slope of up to 18
    CHECK(longest < 1e-4);
    CHECK(least_z > 0);
  }
}

TEST_CASE("depth uses its range and is rarely clipped") {
  for (const Made& made : all_made()) {
    CAPTURE(made.recipe.about.name);
    double least = 1, most = 0;
    int cut = 0;
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) {
        const double depth = depth_at(made.texture, x, y);
        least = std::min(least, depth);
        most = std::max(most, depth);
        cut += depth == 0 || depth == 1;
      }
    }
    CHECK(least < 0.08);
    CHECK(most > 0.7);
    CHECK(cut < 0.01 * 512 * 512);
  }
}

TEST_CASE("stone_blocks has the most near-vertical edges") {
  double blocks = 0, others = 0;
  for (const Made& made : all_made()) {
    double& side = made.recipe.about.name == "stone_blocks" ? blocks : others;
    side = std::max(side, near_vertical(made.texture));
  }
  CHECK(blocks > 0.05);
  CHECK(blocks > 1.5 * others);
}

TEST_CASE("the default of make_brick is brick_running") {
  CHECK(hash_of(make_brick({})) == hash_of(make_texture(find_builtin("brick").value(), 512)));
  CHECK(find_builtin("brick")->about.name == "brick_running");
}

TEST_CASE("Fractal equals gradient noise whose gradients are hashed at every point") {
  const Fractal fractal(12, 12, 4, 0.6, 5);
  for (const double u : {-0.3, 0.0, 0.123, 0.5, 0.99999, 1.7}) {
    for (const double v : {-1.1, 0.0, 0.25, 0.871})
      CHECK(fractal(u, v) == periodic_fractal(u, v, 12, 4, 0.6, 5));
  }
  CHECK(Fractal(3, 7, 2, 0.5, 1)(-1e-18, -1e-18) == doctest::Approx(Fractal(3, 7, 2, 0.5, 1)(0, 0)));
}
