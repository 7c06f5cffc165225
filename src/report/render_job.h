// `intaglio render`: a scene into a video with sound, its logs and its report, offline and deterministic. A
// software driver draws with threads of its own, whatever `threads` says: LP_NUM_THREADS sets llvmpipe's, and
// is read when the process makes its first context.
#pragma once

#include <atomic>
#include <filesystem>

#include "scene/scene.h"
#include "session/run.h"

namespace intaglio::report {

struct RenderJob {
  std::filesystem::path output;  // .mp4; beside it go .wav, .html, .events.csv and .servo.csv
  int threads = 2;               // 2: render and encode in parallel with the simulation
  bool quiet = false;
  const std::atomic<bool>* stop = nullptr;  // set from another thread to abandon the work with an error
};

// Puts all files in place together (core/output_files.h); on an error the old ones remain as they were.
// Sound, logs and pictures are written while the simulation runs, so that memory does not depend on the
// duration.
Result<session::Run> render(const scene::Scene& scene, const RenderJob& job);

}  // namespace intaglio::report
