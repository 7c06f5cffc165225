// Reloading shaders from a folder.
#include "core/file.h"
#include "render/programs.h"
#include "tests/render/scenes.h"
#include "tests/temporary_folder.h"

namespace intaglio::render::test {

TEST_CASE("a folder's shaders are used; one that does not compile is named, and the picture stays") {
  if (!have_gl()) return;
  const tests::TemporaryFolder temporary;
  const auto& folder = temporary.path;
  const auto renderer = make_renderer(brick(), small_options());
  const Image8 before = renderer->draw(target_scene());
  CHECK_FALSE(renderer->reload_shaders(folder));  // nothing there

  std::string lighting = embedded_shaders().at("lighting.glsl");
  REQUIRE(write_file(folder / "lighting.glsl", lighting + "\nfloat broken( {"));
  const auto broken = renderer->reload_shaders(folder);
  REQUIRE_FALSE(broken);
  CHECK(broken.error().message().find("lighting.glsl:") != std::string::npos);
  CHECK(renderer->draw(target_scene()).data == before.data);

  const std::string curve = "vec3 film(vec3 x) { return ";
  const auto at = lighting.find(curve);
  REQUIRE(at != std::string::npos);
  lighting.insert(at + curve.size(), "0.0 * ");
  REQUIRE(write_file(folder / "lighting.glsl", lighting));
  REQUIRE(renderer->reload_shaders(folder));
  CHECK(renderer->draw(target_scene()).data != before.data);
}

}  // namespace intaglio::render::test
