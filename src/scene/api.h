// Implementation of intaglio::Scene (include/intaglio/scene.h), for the libraries that are handed one.
#pragma once

#include "intaglio/scene.h"
#include "scene/scene.h"

namespace intaglio {

struct Scene::Impl {
  scene::Scene scene;
};

}  // namespace intaglio
