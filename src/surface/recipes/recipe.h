// A built-in material's recipe: a layout of pieces, the profile from a joint up to a piece, layers of detail
// on them, and paint. Plain values; lengths are fractions of the tile's side, depths fractions of the full
// depth (0 = top), colours sRGB in 0..1. Every field is a key of the recipe's file, explained in
// docs/materials.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "intaglio/material.h"
#include "intaglio/vec.h"

namespace intaglio::surface {

enum class Study { none, identification, comparison };  // §1.4.2.1, §1.4.3.1

// What the senses besides the images need to know.
struct BuiltinMaterial {
  std::string name, title;
  Study study = Study::none;
  int study_number = 0;          // the paper's number of the material in that study
  Material material;             // what it sounds like, and its micro roughness
  double depth_fraction = 0.02;  // suggested full depth over the side of the tile
  double roughness = 0.55;       // suggested for the renderer: 0 = mirror, 1 = chalk
};

enum class Pattern { sheet, bond, herringbone, voronoi, scatter, lugs, weave };

// Where the pieces lie.
struct LayoutRecipe {
  Pattern pattern = Pattern::sheet;
  int columns = 4;
  int rows = 8;
  double joint = 0.018;        // width of the joint's floor
  double corner = 0.014;       // radius of the pieces' corners
  double shift = 0;            // of every other row, in columns
  double stagger = 0;          // of every row by chance, in columns
  Vec2 uneven = Vec2::Zero();  // how far joints stray by chance, in columns and rows
  double split = 0;            // share of the bond's pieces that are cut in two
  double jitter = 0.8;         // of Voronoi sites and lugs, in cells
  int length = 4;              // of a herringbone's piece, in widths
  int stones = 400;            // of a scatter
  Vec2 radius =
      Vec2(0.015, 0.055);  // of the scatter's smallest and largest stone; of a lug: half width, half length
  double wire = 0.6;       // width of a weave's wires over their spacing
  double warp = 0;         // how far a slow noise bends outlines ...
  int warp_frequency = 9;
  double chip = 0;  // ... and a fine one chips them
  int chip_frequency = 40;
};

// From the joint up to the piece and over it.
struct ProfileRecipe {
  double bevel = 0.010;  // width of the slope from the joint to the face
  double wear = 0.10;    // depth by which the face falls off towards the bevel
  double face = 0.05;    // depth of the highest faces
  double joint = 0.93;   // depth of the joint's floor
  double lift = 0.07;    // depth by which faces differ from piece to piece
  double tilt = 0.04;    // depth by which they tilt
  double crown = 0;      // depth by which the layout's own relief goes down: a stone's dome, a wire's wave
};

enum class Detail { noise, pits, veins, steps, grain, scratches, rivets, rosette };
enum class On { pieces, joints, both };
enum class Along { tile, piece };

// One detail: a value over the tile, 0..1 or -1..1, that moves depth and paints.
struct LayerRecipe {
  Detail detail = Detail::noise;
  On on = On::pieces;
  Along along = Along::tile;  // whose axes it follows; along a piece it starts anew on each
  int stream = 0;             // added to the recipe's seed
  double depth = 0;           // added to the depth, times the value: positive is deeper
  double shade = 0;           // the colour is multiplied by 1 + shade x value
  double paint_amount = 0;    // share of `paint` in the colour, times the value
  Vec3 paint = Vec3::Zero();
  int frequency_u = 16;  // lattice cells a side
  int frequency_v = 16;
  int octaves = 3;
  double gain = 0.5;       // of each octave
  double threshold = 0.2;  // pits: how deep the noise must go; steps: sharpness
  double width = 0.05;     // veins: in noise; scratches, rivets, rosette: fraction of the side
  double length = 0.2;     // scratches
  double direction = 0;    // scratches: degrees from u
  double spread = 180;     // and degrees by which they stray
  int count = 40;          // scratches; rings of the grain a side; steps; petals; rivets a side of a piece
  double inset = 0.02;     // rivets: from the piece's outline
  double bend = 1;         // grain: how many rings the noise moves it
  int knots = 0;           // grain
  double knot = 0.02;      // grain: radius of the largest knot
};

struct ColourRecipe {
  std::vector<Vec3> pieces = {Vec3(0.5, 0.5, 0.5)};  // a piece is somewhere along this list
  bool checker = false;                              // pieces take them in turn instead
  Vec2 shade = Vec2(1, 1);                           // darkest and lightest piece
  Vec3 joint = Vec3(0.5, 0.5, 0.5);
  Vec3 rim = Vec3::Zero();  // what a piece's edge fades to
  double rim_amount = 0;
  double rim_reach = 0.01;
};

struct BuiltinRecipe {
  BuiltinMaterial about;
  std::uint64_t seed = 7;
  LayoutRecipe layout;
  ProfileRecipe profile;
  std::vector<LayerRecipe> layers;
  ColourRecipe colour;
};

}  // namespace intaglio::surface
