// The modal models of a scene: floor, grounds, bodies and pen, each baked once, or read from a folder of
// models that were baked before: `models` beside the scene's file (`intaglio bake --scene` fills it, and
// shipped scenes have theirs), then a cache. A model is known by its identity, the hash of what it is baked
// from (modal_model.h), which is its name there.
//
// Takes seconds where models are missing, milliseconds where not. Any thread; the models are immutable. A
// slab is a box, a curved ground the slab over its bounds, a letter the box about it, a capsule a cylinder:
// the sound is exact for balls, boxes and cylinders, approximate for the others.
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

// A body that rings: what was baked for it.
struct Voice {
  BodyId body = 0;
  std::string name;  // "floor", "ball 1", "pen"
  std::string material;
  std::vector<double> frequencies;  // Hz, ascending
  std::vector<double> t60;          // s, of each mode
};

struct VoiceOptions {
  std::filesystem::path cache = {};            // folder of models, where new ones go; empty: none
  const std::atomic<bool>* stopped = nullptr;  // when it turns true, no further model is begun
  // Folder of models beside the scene's file; empty: none.
  std::string beside = "models";
};

struct Voices {
  std::vector<sound::SoundBody> bodies;
  std::vector<Voice> voices;        // the same, for people
  int baked = 0;                    // models that were in neither folder
  std::vector<std::string> models;  // identities, each once
};

Result<Voices> bake_voices(const Scene& scene, const SceneSurface& surface, const VoiceOptions& options = {});

sound::SynthesizerOptions synthesizer_options(const Scene& scene);

// Makes a scene's modal models in a thread of its own, one scene at a time (the solver below stands no
// second one), and never makes anybody wait: what nobody wants any more is finished, kept in the cache, and
// dropped. One thread asks (the window's).
//
// A model that is being made when the baker dies cannot be interrupted: its thread is left behind. A program
// that ends then should do so by std::_Exit; is_busy() tells.

class VoiceBaker {
 public:
  VoiceBaker();
  ~VoiceBaker();
  VoiceBaker(const VoiceBaker&) = delete;
  VoiceBaker& operator=(const VoiceBaker&) = delete;

  // Asks for these voices instead of any before; the ticket is for take().
  std::uint64_t ask(const Scene& scene, const SceneSurface& surface, const std::filesystem::path& cache);
  // Once they are there, once.
  std::optional<Result<Voices>> take(std::uint64_t ticket);
  bool is_busy() const;

 private:
  struct Shared;
  static void work(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;
};

}  // namespace intaglio::scene
