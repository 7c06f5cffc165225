// Any text as a scene file: a scene or one clear error on one line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "scene/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto scene = intaglio::scene::parse_scene({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
  if (scene) return 0;
  const std::string message = scene.error().message();
  if (message.find('\n') != std::string::npos || message.find("fuzz.toml") != 0) std::abort();
  return 0;
}
