// Implementation of intaglio::Recording (include/intaglio/session.h), for the libraries that are handed one.
#pragma once

#include <vector>

#include "intaglio/session.h"
#include "scene/surfaces.h"
#include "session/recording.h"

namespace intaglio {

struct Recording::Impl {
  Scene scene;
  scene::SceneSurface surface;
  session::Recording recording;
  std::vector<FrameState> frames;
};

}  // namespace intaglio
