// Options of `intaglio bake`, and its forms --all and --scene.
#pragma once

#include <string>
#include <vector>

#include "command/verb.h"
#include "intaglio/material.h"
#include "sound/bake/bake.h"
#include "sound/modal_model.h"

namespace intaglio::app {

struct BakeArguments {
  std::string mesh, material, output;
  std::string all;  // a folder of meshes, instead of `mesh`
  int jobs = 1;
  int modes = 100;
  int elements = 40'000;
  double max_frequency = 20'000;
  double scale = 1;
  double element_size = 0;      // metres; 0: automatic
  int nodes = 10;               // of an element
  double thickness = 0;         // metres, of a shell; 0: a solid
  std::string mesher = "auto";  // "lattice", "netgen" or "auto"
  std::string shell = "solid";  // "solid" elements or "springs"
  double merge_db = 0.5;        // largest change of a band by merging; 0: no merging
  std::string scene;            // every model of this scene, instead of `mesh`
  bool json = false;
  std::uint64_t allowed_memory = default_allowed_memory;  // of Common
};

inline sound::ModeOptions mode_options(const BakeArguments& options) {
  return {options.modes, 20, options.max_frequency};
}

// A hash, in hex, of everything that the model depends on: the mesh's bytes (for .gltf with the .bin files of
// its folder), the material and the options. Equal ones need no second bake.
Result<std::string> source_hash(const BakeArguments& options, const Material& material);

// Bakes every mesh of a folder and below it, one process each (MUMPS has global state), `jobs` at once. Skips
// models that are up to date, so an interrupted run can be resumed. Prints a line for each; returns the exit
// code.
int bake_all(const BakeArguments& options, const Common& common);

// Bakes every model that a scene's sound needs into a folder, except those already there. Scenes look for
// them in `models` beside the scene file. Returns the exit code.
int bake_scene(const BakeArguments& options, const Common& common);

}  // namespace intaglio::app
