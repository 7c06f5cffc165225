// What of a scene rings: the modal models of floor, grounds, bodies and pen, baked once each or taken from a
// folder of models baked before.
//
// Takes seconds without such a folder, milliseconds with it. Any thread; the models are immutable. A slab is
// a box, a curved ground the slab over its bounds, a letter the box about it, a capsule a cylinder: what is
// heard is right for balls, boxes, cylinders.
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
  std::filesystem::path cache;                 // folder of models; empty: always bake
  const std::atomic<bool>* stopped = nullptr;  // when it turns true, no further model is begun
};

struct Voices {
  std::vector<sound::SoundBody> bodies;
  std::vector<Voice> voices;  // the same, for people
  int baked = 0;              // models that were not in the cache
};

Result<Voices> bake_voices(const Scene& scene, const SceneSurface& surface, const VoiceOptions& options = {});

sound::SynthesizerOptions synthesizer_options(const Scene& scene);

}  // namespace intaglio::session
