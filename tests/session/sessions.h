// Scenes from text, and waiting for a live session, for the tests of session.
#pragma once

#include <doctest/doctest.h>

#include <chrono>
#include <string>
#include <thread>

#include "scene/scene_reader.h"
#include "scene/voices/voices.h"
#include "session/live_session.h"
#include "tests/temporary_folder.h"

namespace intaglio::tests {

inline scene::Scene parsed(const std::string& text) {
  auto scene = scene::parse_scene(text, "s.toml");
  REQUIRE_MESSAGE(scene, (scene ? "" : scene.error().message()));
  return *scene;
}

// Models of one shape and material are baked once by a test program, not once by a session.
inline scene::VoiceOptions cached_models() {
  static const TemporaryFolder folder;
  return {.cache = folder.path};
}

// Waits, for at most ten seconds, until the state is as wanted.
template <class Wanted>
bool wait_for(session::LiveSession& session, Wanted&& wanted) {
  for (int k = 0; k < 2000; ++k) {
    if (wanted(session.state())) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace intaglio::tests
