// What is behind intaglio::Surface (include/intaglio/surface.h), for the libraries that are handed one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "intaglio/surface.h"
#include "surface/surface.h"

namespace intaglio {

struct Surface::Impl {
  std::shared_ptr<const surface::Surface> surface;
  Pose pose;
  Material material;
  double roughness = 0.55;  // for the renderer, 0..1
  std::vector<std::string> notes, warnings;
};

}  // namespace intaglio
