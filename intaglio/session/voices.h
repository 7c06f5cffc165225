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
#include <vector>

#include "intaglio/session/recording.h"
#include "intaglio/session/scene.h"
#include "intaglio/session/scene_surface.h"
#include "intaglio/sound/synthesizer.h"

namespace intaglio::session {

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

}  // namespace intaglio::session
