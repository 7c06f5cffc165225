// `intaglio render`: a scene into a video with sound, its logs and its report, offline and deterministic.
#pragma once

#include <atomic>
#include <filesystem>

#include "scene/scene.h"
#include "session/recording.h"

namespace intaglio::session {

struct RenderJob {
  std::filesystem::path output;  // .mp4; beside it go .wav, .html, .events.csv and .servo.csv
  int threads = 2;               // 2: pictures are drawn and encoded while the senses go on
  bool quiet = false;
  const std::atomic<bool>* interrupted = nullptr;  // set from outside to stop early; nothing is left behind
};

// Leaves all files or, on an error, none of them.
Result<Recording> render(const Scene& scene, const RenderJob& job);

}  // namespace intaglio::session
