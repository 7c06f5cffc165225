// `intaglio render`: a scene into a video with sound, its logs and its report, offline and deterministic.
#pragma once

#include <atomic>
#include <filesystem>

#include "session/recording.h"
#include "scene/scene.h"

namespace intaglio::report {

struct RenderJob {
  std::filesystem::path output;  // .mp4; beside it go .wav, .html, .events.csv and .servo.csv
  int threads = 2;               // 2: pictures are drawn and encoded while the senses go on
  bool quiet = false;
  const std::atomic<bool>* interrupted = nullptr;  // set from outside to stop early; nothing is left behind
};

// Leaves all files or, on an error, none of them.
Result<session::Recording> render(const scene::Scene& scene, const RenderJob& job);

}  // namespace intaglio::report
