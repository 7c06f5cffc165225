// Any text as a scene file: a scene or one clear error on one line.
#include "scene/scene.h"
#include "fuzz/require.h"

using namespace intaglio;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto scene = scene::parse_scene(fuzz::as_text(data, size), "fuzz.toml");
  if (!scene) fuzz::require_clear(scene.error(), "fuzz.toml");
  return 0;
}
