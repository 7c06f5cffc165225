// The modal models of a scene: floor, grounds, bodies and pen, each baked once, or read from a folder of
// models baked earlier: `models` beside the scene's file (`intaglio bake --scene` fills it; shipped scenes
// have theirs), then a cache. A model file is named by its identity, the hash of its inputs (modal_model.h).
//
// Seconds when models must be baked, otherwise milliseconds. Any thread; the models are immutable. A slab is
// a box, a curved ground the slab over its bounds, a letter its bounding box, a capsule a cylinder: the sound
// is exact for balls, boxes and cylinders, approximate for the others.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "scene/scene.h"
#include "scene/surfaces.h"
#include "sound/synthesizer.h"

namespace intaglio::scene {

// Summary of a sounding body's model, for reports.
struct Voice {
  BodyId body = 0;
  std::string name;  // "floor", "ball 1", "pen"
  std::string material;
  std::vector<double> frequencies;  // Hz, ascending
  std::vector<double> t60;          // s, of each mode
};

struct VoiceOptions {
  std::filesystem::path cache = {};                   // cache folder for newly baked models; empty: no cache
  const std::atomic<bool>* stop_requested = nullptr;  // set to stop before the next bake
  // Folder of models beside the scene's file; empty: none.
  std::string beside = "models";
};

struct Voices {
  std::vector<sound::SoundBody> bodies;
  std::vector<Voice> voices;        // of the same bodies
  int baked = 0;                    // number of models that were in neither folder
  std::vector<std::string> models;  // distinct identities
};

Result<Voices> bake_voices(const Scene& scene, const SceneSurface& surface, const VoiceOptions& options = {});

sound::SynthesizerOptions synthesizer_options(const Scene& scene);

// Bakes a scene's modal models in a thread of its own, one scene at a time (the solver is not reentrant), and
// never blocks its caller: a model that is no longer wanted is finished, cached and dropped. One thread calls
// it (the window's).
//
// A bake cannot be interrupted: when the baker is destroyed during one, its thread is left behind. A program
// that ends then should call std::_Exit; see is_busy().

class VoiceBaker {
 public:
  VoiceBaker();
  ~VoiceBaker();
  VoiceBaker(const VoiceBaker&) = delete;
  VoiceBaker& operator=(const VoiceBaker&) = delete;

  // Replaces any earlier request. The ticket is for take().
  std::uint64_t request(const Scene& scene, const SceneSurface& surface, const std::filesystem::path& cache);
  // The voices, once, when they are ready.
  std::optional<Result<Voices>> take(std::uint64_t ticket);
  // A bake is running, or is about to.
  bool is_busy() const;

 private:
  struct Shared;
  static void work(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;
};

}  // namespace intaglio::scene
