// The modal models of scenes: shipped ones are found, all of them and no others; a cache is filled and used;
// and they are baked on a thread.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <set>
#include <thread>

#include "core/file.h"
#include "scene/surfaces.h"
#include "scene/voices/voices.h"
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

namespace {

// A floor that no folder has a model of; baking 400 modes takes seconds.
Scene slow_scene(int modes) {
  return parse_scene("[sound]\nmodes = " + std::to_string(modes) + "\n[surface]\nsize = [0.731, 0.657]\n",
                     "slow.toml")
      .value();
}

std::ptrdiff_t threads() {
  return std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator());
}

}  // namespace

TEST_CASE("a baker is busy from the request on, and its end joins its thread amid a bake") {
  const Scene scene = slow_scene(400);
  const SceneSurface surface = make_surface(scene).value();
  const std::ptrdiff_t before = threads();
  auto baker = std::make_unique<VoiceBaker>();
  CHECK_FALSE(baker->is_busy());
  const std::uint64_t ticket = baker->request(scene, surface, "");
  CHECK(baker->is_busy());
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(baker->is_busy());
  CHECK_FALSE(baker->take(ticket));
  // In processor time: on a busy machine the thread, of low priority, may wait for its turn.
  const std::clock_t start = std::clock();
  baker.reset();
  const double took = double(std::clock() - start) / CLOCKS_PER_SEC;
  MESSAGE("stopped within " << took << " CPU-s");
  CHECK(took < 1);
  CHECK(threads() == before);
}

TEST_CASE("a superseded request is dropped, and the newer one is answered") {
  const Scene slow = slow_scene(10), quick = small_scene();
  VoiceBaker baker;
  const std::uint64_t first = baker.request(slow, make_surface(slow).value(), "");
  const std::uint64_t second = baker.request(quick, make_surface(quick).value(), "");
  std::optional<Result<Voices>> voices;
  for (int k = 0; k < 60'000 && !voices; ++k) {
    if (k % 100 == 0) CHECK_FALSE(baker.take(first));
    voices = baker.take(second);
    if (!voices) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  REQUIRE(voices);
  REQUIRE(*voices);
  CHECK((*voices)->bodies.size() == 3);
  CHECK_FALSE(baker.is_busy());
}
