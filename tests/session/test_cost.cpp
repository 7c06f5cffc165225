#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "scene/cost.h"
#include "scene/surfaces.h"
#include "tests/source_folder.h"

using namespace intaglio;

namespace {

scene::Scene big_scene(const std::string& text) {
  auto scene = scene::parse_scene(text, "big.toml");
  REQUIRE(scene);
  return *scene;
}

std::string times_over(const std::string& text, int times) {
  std::string out;
  for (int k = 0; k < times; ++k) out += text;
  return out;
}

std::string refusal(const scene::Scene& scene) {
  const auto checked = scene::check_cost(scene, scene::Use::kept);
  return checked ? "" : checked.error().message();
}

}  // namespace

TEST_CASE("every shipped scene keeps half of the default budget") {
  int scenes = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::filesystem::path(tests::source_folder) / "scenes")) {
    if (file.path().extension() != ".toml") continue;
    const auto scene = scene::read_scene(file.path());
    REQUIRE(scene);
    const MemoryCost cost = scene::memory_cost(*scene, scene::Use::kept);
    CHECK_MESSAGE(cost.total() < 0.5 * default_allowed_memory, file.path().string(), ": ", cost.parts());
    ++scenes;
  }
  CHECK(scenes >= 9);
}

TEST_CASE("a scene beyond its budget names its largest part first, and a larger budget allows it") {
  scene::Scene scene = big_scene(times_over("[[ball]]\n", 10'000));
  CHECK(refusal(scene).find("big.toml: would need about ") == 0);
  CHECK(refusal(scene).find("GB (recording ") != std::string::npos);
  CHECK(refusal(scene).find("more than the 2 GB allowed; pass --allow-memory ") != std::string::npos);
  // A rendering writes as it goes.
  CHECK(scene::check_cost(scene, scene::Use::shown));
  scene.allowed_memory = 100'000'000'000;
  CHECK(refusal(scene).empty());
}

TEST_CASE("hours at the highest rates are refused where all is kept") {
  for (const char* text : {"[pen]\ndevice_rate = 20000\npath = [[0, 0, 0.1, 0]]\n",
                           "[physics]\nrate = 20000\n[[ball]]\n", "[sound]\nsample_rate = 192000\n"}) {
    const scene::Scene scene = big_scene("duration = 3600\n" + std::string(text));
    CHECK(refusal(scene).find("(recording ") != std::string::npos);
    CHECK(scene::check_cost(scene, scene::Use::shown));
  }
}

TEST_CASE("no budget allows more bodies than a step can move") {
  scene::Scene scene = big_scene(times_over("[[ball]]\n", int(scene::max_bodies) + 1));
  scene.allowed_memory = 1'000'000'000'000;
  CHECK(refusal(scene).find("big.toml: has 16385 bodies; at most 16384") == 0);
}

TEST_CASE("a scene file cannot raise its own budget") {
  CHECK_FALSE(scene::parse_scene("allowed_memory = 8000000000\n", "big.toml"));
  CHECK_FALSE(scene::parse_scene("allow_memory = \"8G\"\n", "big.toml"));
}

TEST_CASE("grounds of one texture share its texels; their rectangles and depths are their own") {
  const auto surface = scene::make_surface(big_scene(
      "[[ground]]\ntexture = \"brick\"\nsize = [2, 2]\n[[ground]]\ntexture = \"brick\"\ndepth = 0.01\n"
      "[[ground]]\ntexture = \"brick\"\ndepth = 0.01\nposition = [3, 0, 0]\n"));
  REQUIRE(surface);
  const auto& large = *surface->grounds[0].surface;
  const auto& shallow = *surface->grounds[1].surface;
  CHECK(large.identity() == surface->surface->identity());
  CHECK(large.max_depth() == doctest::Approx(2 * surface->surface->max_depth()));
  // Another depth means other normals.
  CHECK(shallow.identity() != large.identity());
  CHECK(shallow.max_depth() == 0.01);
  CHECK(surface->grounds[2].surface->identity() == shallow.identity());
  CHECK(surface->grounds[2].surface->placement().to_world({0.5, 0.5, 0}).isApprox(Vec3(3, 0, 0)));
}
