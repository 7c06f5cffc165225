// What `intaglio bake` is asked, and the two ways to do it.
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
  double element_size = 0;      // metres; 0: chosen
  int nodes = 10;               // of an element
  double thickness = 0;         // metres, of a shell; 0: a solid
  std::string mesher = "auto";  // of a mesh: "lattice", "netgen" or "auto"
  std::string shell = "solid";  // what a shell is made of: "solid" elements or "springs"
  double merge_db = 0.5;        // merging may change a band by so much; 0: no merging
  std::string scene;            // every model of this scene, instead of `mesh`
  bool json = false;
};

inline sound::ModeOptions mode_options(const BakeArguments& arguments) {
  return {arguments.modes, 20, arguments.max_frequency};
}

// A hash, in hex, of the mesh's bytes (for .gltf with the .bin files of its folder), of the material and of
// everything that changes the model: equal ones need no second bake.
Result<std::string> source_hash(const BakeArguments& arguments, const Material& material);

// Every mesh of a folder and below it, one process each (MUMPS keeps global state), `jobs` at once. A model
// that was baked from the same source is left as it is, so that a run that was stopped goes on where it was.
// Prints a line for each; returns the exit code.
int bake_all(const BakeArguments& arguments, const Common& common);

// Every model that a scene's sound needs, into a folder: one beside the scene, `models`, is where it will be
// looked for. Those already there are left as they are. Returns the exit code.
int bake_scene(const BakeArguments& arguments, const Common& common);

}  // namespace intaglio::app
