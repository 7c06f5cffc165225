// A session without its data: what ran, the measures of the whole, and their cost. SI units.
//
// The first part is known before the first step, the second after the last; memory does not depend on the
// duration.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "intaglio/event.h"
#include "intaglio/image.h"
#include "intaglio/representation.h"
#include "scene/voices/voices.h"
#include "session/cost_meter.h"
#include "surface/surface.h"

namespace intaglio::session {

struct Ball {
  BodyId body = 0;
  double radius = 0;  // m
};

struct KeyFrame {
  double time = 0;  // s
  Image8 image;     // RGB, row 0 = top
};

struct Run {
  std::string title;
  double duration = 0;                                                       // s
  int physics_rate = 480, servo_rate = 1000, sample_rate = 44100, fps = 30;  // Hz
  Representation representation = Representation::relief;
  std::shared_ptr<const surface::Surface> surface;
  std::string texture;  // as the scene names it
  // What the pen is given to feel: these two, unless the scene's cues say otherwise.
  std::shared_ptr<const surface::Surface> felt_surface;
  std::string felt_texture;
  scene::Cues cues;
  std::vector<std::string> notes;     // import notes, one per line
  std::vector<std::string> warnings;  // what the scene asks of a device beyond its abilities, one per line
  std::vector<Ball> balls;
  BodyId pen = 0;  // 0: no pen
  std::vector<scene::Voice> voices;
  double bake_s = 0;  // CPU time of the modal analysis
  std::size_t surface_bytes = 0;

  std::vector<KeyFrame> key_frames;
  std::vector<SenseCost> costs;
  double wall_s = 0;                  // of the whole run
  double momentum_residual = 0;       // N s, dynamics::World::momentum_residual()
  std::size_t peak_memory_bytes = 0;  // resident, of the process
  std::size_t event_count = 0;
  std::uint64_t event_hash = 0;
  std::uint64_t audio_hash = 0;
};

}  // namespace intaglio::session
