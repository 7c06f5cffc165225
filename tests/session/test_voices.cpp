// The scene's modal models: shipped ones are found and complete; a cache is filled and used.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <thread>

#include "core/file.h"
#include "scene/surfaces.h"
#include "scene/voices.h"
#include "sound/model_file.h"
#include "tests/source_folder.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::scene;
namespace fs = std::filesystem;

namespace {

const fs::path scenes = std::string(tests::source_folder) + "/scenes";

Scene small_scene() {
  return parse_scene(
             "[sound]\nmodes = 10\n[[ball]]\nradius = 0.05\nmaterial = \"plastic\"\n[[ball]]\nradius = "
             "0.05\nmaterial = \"plastic\"\n",
             "small.toml")
      .value();
}

}  // namespace

TEST_CASE("every shipped scene finds its models beside it, and no model is unused") {
  std::set<std::string> used, there;
  for (const auto& entry : fs::directory_iterator(scenes)) {
    if (entry.path().extension() != ".toml") continue;
    CAPTURE(entry.path().filename().string());
    const Scene scene = read_scene(entry.path()).value();
    const auto voices = bake_voices(scene, make_surface(scene).value());
    REQUIRE(voices);
    CHECK(voices->baked == 0);  // else: intaglio bake --scene scenes/NAME.toml -o scenes/models
    used.insert(voices->models.begin(), voices->models.end());
  }
  for (const auto& entry : fs::directory_iterator(scenes / "models"))
    there.insert(entry.path().stem().string());
  CHECK(used == there);
}

TEST_CASE("a baker is busy from the request on, so that a program that quits then does not cut it off") {
  VoiceBaker baker;
  const Scene scene = small_scene();
  const SceneSurface surface = make_surface(scene).value();
  const std::uint64_t ticket = baker.request(scene, surface, {});
  CHECK(baker.is_busy());
  for (int k = 0; k < 24'000 && baker.is_busy(); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK_FALSE(baker.is_busy());
  CHECK(baker.take(ticket).has_value());
}

TEST_CASE(
    "models are baked once, cached by their inputs, and baked again when a cached file does not match") {
  const Scene scene = small_scene();
  const SceneSurface surface = make_surface(scene).value();
  const tests::TemporaryFolder folder;
  const VoiceOptions options{folder.path};
  const auto first = bake_voices(scene, surface, options);
  REQUIRE(first);
  CHECK(first->models.size() == 2);  // the floor's, and one of both balls
  CHECK(first->baked == 2);
  const auto second = bake_voices(scene, surface, options);
  CHECK(second->baked == 0);
  CHECK(second->models == first->models);
  for (std::size_t k = 0; k < first->bodies.size(); ++k)
    CHECK(sound::model_bytes(*first->bodies[k].model) == sound::model_bytes(*second->bodies[k].model));
  // A file with another identity, or a broken one, is ignored.
  const auto file = [&](int k) { return folder.path / (first->models[std::size_t(k)] + ".modes"); };
  fs::copy_file(file(0), file(1), fs::copy_options::overwrite_existing);
  CHECK(bake_voices(scene, surface, options)->baked == 1);
  CHECK(write_file(file(0), std::vector<std::uint8_t>(100)));
  CHECK(bake_voices(scene, surface, options)->baked == 1);
  // Another material gives another model.
  Scene other = scene;
  for (BallSettings& ball : other.balls) ball.material.density *= 1.01;
  CHECK(bake_voices(other, surface, options)->models != first->models);
}
