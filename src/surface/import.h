// From a user's images to the canonical texels of a Surface: unit normals, +Y; depth fraction, 0 = top; row 0
// = v 0.
//
// What the files' conventions are is detected (maps.h) and can be overridden; what was found is said in
// `notes` and, where something does not fit, in `warnings`. By default height and normals are fused into one
// consistent field (fuse.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "surface/recipes/builtin.h"
#include "surface/surface.h"

namespace intaglio::surface {

enum class Green { plus_y, minus_y };
enum class Polarity { depth, height };  // what white means: deep, or high
enum class ImportMode {
  fused,  // height and normals made one; a normal map alone is integrated to an implied height
  raw,    // the maps as they are, the paper's way: normals need not be those of the depth
};

struct ImportOptions {
  std::optional<Green> green;        // unset: detected, else by the file's name, else +Y
  std::optional<Polarity> polarity;  // unset: detected, else height (alpha: depth, the paper's convention)
  std::optional<bool> flip_height_rows;  // unset: detected
  std::optional<double>
      depth_fraction;  // full depth over the side of the tile; unset: what the normals imply, else 0.02
  ImportMode mode = ImportMode::fused;
  Edge edge = Edge::wrap;    // whether the tile repeats, for the fusion
  int generated_size = 512;  // texels a side of a texture that is made from a recipe, 64 to 8192
};

// What import found out. Correlations are 0 where there was only one map.
struct ImportReport {
  bool generated = false;  // from a recipe: no files
  std::filesystem::path normal_file, height_file, colour_file;
  int height_channel = 0;  // 3: the alpha channel of the normal map
  int normal_bits = 0, height_bits = 0;
  Green green = Green::plus_y;  // as it was taken: overridden, detected, or by name and default
  Polarity polarity = Polarity::height;
  std::optional<Green> detected_green;  // set when the maps agree
  std::optional<Polarity> detected_polarity;
  bool rows_differed = false;
  double correlation = 0, correlation_u = 0, correlation_v = 0;
  double implied_depth = 0;  // 0: not known
  double curl = 0;           // share of the normals' slopes that no height can have
  double mean_slope_u = 0, mean_slope_v = 0;
  double clamped_normals = 0;  // fraction of texels whose slope was beyond max_slope
  double lambda = 0;
};

// Slopes beyond this (87 degrees) are held at it: an 8-bit normal cannot tell them apart.
inline constexpr double max_slope = 20;

struct Imported {
  Texels texels;
  double depth_fraction = 0.02;  // full depth (texel depth 1) over the side of the tile
  ImportReport report;
  std::vector<std::string> notes, warnings;  // one line each
};

// `path` is an image, a folder of images, or what recipe_named (builtin/builtin.h) knows: the name of a
// built-in material or a recipe, whose texture is made at `generated_size` and is consistent as it is.
//   RGBA image       normals in RGB, depth or height in alpha; a colour map beside it is found by its name
//   RGB image        normals if it looks like normals (a height map beside it is found by its name), else its
//   brightness is taken as height grey image       height folder           searched for normal, height and
//   colour by the usual names
Result<Imported> import_texture(const std::filesystem::path& path, const ImportOptions& options);

// The built-in images, through the same conversion of pixels.
Texels to_texels(const TextureImages& images);

// Which image of a texture is what, by the names that artists and libraries give them.

// Any of the three may be empty, but not both of the first.
struct TextureFiles {
  std::filesystem::path normal, height, colour;
};

// `path` is a folder, searched by the usual names (nor_gl, NormalDX, disp, height, diff, Color, ...; an image
// whose name claims no role is the colour map), or one image. That image is then in `normal`, whatever it is:
// the caller decides by its pixels. The height and colour maps that lie beside it under the same name are
// found as well.
Result<TextureFiles> find_texture_files(const std::filesystem::path& path);

// Whether a normal map's name says that its green channel is -Y (DirectX).
bool named_directx(const std::filesystem::path& path);

// A surface as files of its own: what `intaglio import` writes and `--surface` reads back.

// Writes `folder`/relief.png (16-bit RGBA: normals +Y in RGB, depth in alpha, 0 = top; RGB where there is no
// depth) and `folder`/color.png. Reading it back detects the same conventions and the same full depth.
Result<void> write_asset(const Imported& imported, const std::filesystem::path& folder);

}  // namespace intaglio::surface
