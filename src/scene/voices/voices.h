// The modal models of a scene: floor, grounds, bodies and pen, each baked once, or read from a folder of
// models that were baked before: `models` beside the scene's file (`intaglio bake --scene` fills it, and
// shipped scenes have theirs), then a cache. A model file is named by its identity, the hash of its inputs
// (bake_hash).
//
// Seconds when models must be baked, otherwise milliseconds. Any thread; the models are immutable. A slab is
// a box, a curved ground the slab over its bounds, a letter its bounding box, a capsule a cylinder: the sound
// is exact for balls, boxes and cylinders, approximate for the others.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
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
  std::filesystem::path cache = {};               // folder for newly baked models; empty: no cache
  std::string shipped = "models";                 // folder of models beside the scene's file; empty: none
  const std::atomic<bool>* stop = nullptr;        // set to abandon a bake under way (sound/bake/bake.h)
  const std::atomic<bool>* begin_none = nullptr;  // set to finish the model under way and begin no other
  std::function<void(int done, int all)> progress = {};  // called before each model is read or baked
};

// Scenes with more different models are refused: each takes about 0.3 s to bake.
inline constexpr std::size_t max_models = 256;

struct Voices {
  std::vector<sound::SoundBody> bodies;
  std::vector<Voice> voices;        // of the same bodies
  int baked = 0;                    // models that were in neither folder
  std::vector<std::string> models;  // distinct identities
};

Result<Voices> bake_voices(const Scene& scene, const SceneSurface& surface, const VoiceOptions& options = {});

sound::SynthesizerOptions synthesizer_options(const Scene& scene);

// Bakes a scene's modal models on a thread of its own, one scene at a time (MUMPS works on one matrix at a
// time), without blocking the caller. When a new request replaces one in progress, the model being baked is
// still finished and cached; the rest of the old request is dropped. The destructor abandons the model being
// baked and joins the thread, which takes some tenths of a second. All functions are called from one thread
// (the window's).
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
  // A request is waiting or being worked on.
  bool is_busy() const;

 private:
  struct State;
  static void work(State& state);

  std::unique_ptr<State> state_;
  std::thread thread_;
};

}  // namespace intaglio::scene
