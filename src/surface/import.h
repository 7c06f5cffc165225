// Imports a user's images as the texels of a Surface: unit normals, +Y; depth fraction, 0 = top; row 0 = v 0.
//
// The files' conventions are detected (maps.h) and can be overridden; findings are reported in `notes` and,
// where something does not fit, in `warnings`. By default height and normals are fused into one consistent
// field (fuse.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/budget.h"
#include "intaglio/error.h"
#include "surface/recipes/builtin.h"
#include "surface/surface.h"

namespace intaglio::surface {

enum class Green { plus_y, minus_y };
enum class Polarity { depth, height };  // white is deep, or high
enum class ImportMode {
  fused,  // height and normals made consistent; a normal map alone is integrated to an implied height
  raw,    // maps unchanged, as in the paper; normals need not match the depth
};

struct ImportOptions {
  std::optional<Green> green;        // unset: detected, else by the file's name, else +Y
  std::optional<Polarity> polarity;  // unset: detected, else height (alpha: depth, the paper's convention)
  std::optional<bool> flip_height_rows;  // unset: detected
  // Full depth over the side of the tile; unset: as implied by the normals, else 0.02.
  std::optional<double> depth_fraction;
  ImportMode mode = ImportMode::fused;
  Edge edge = Edge::wrap;    // whether the tile repeats, for the fusion
  int generated_size = 512;  // texels per side of a texture generated from a recipe, 64 to 8192
  std::uint64_t allowed_memory = default_allowed_memory;  // bytes; a texture that needs more is refused
};

// How large a texture is, by the headers of its files alone; zero where they cannot be read.
struct TextureExtent {
  double texels = 0, coloured = 0;  // of its maps, and of its colour map

  double import_bytes(const ImportOptions& options) const;  // the peak while it is imported
  double surface_bytes() const;                             // as a Surface, afterwards
};
TextureExtent texture_extent(const std::filesystem::path& path, int generated_size);

// The findings of an import. Correlations are 0 where there was only one map.
struct ImportReport {
  bool generated = false;  // from a recipe, without files
  std::filesystem::path normal_file, height_file, colour_file;
  int height_channel = 0;  // 3: the alpha channel of the normal map
  int normal_bits = 0, height_bits = 0;
  Green green = Green::plus_y;  // as used: overridden, detected, or by name and default
  Polarity polarity = Polarity::height;
  std::optional<Green> detected_green;  // set when the maps agree
  std::optional<Polarity> detected_polarity;
  bool rows_flipped = false;
  double correlation = 0, correlation_u = 0, correlation_v = 0;
  double implied_depth = 0;  // 0: unknown
  double curl = 0;           // root of the fraction of the slopes' energy that is not curl-free
  double mean_slope_u = 0, mean_slope_v = 0;
  double clamped_normals = 0;  // fraction of texels whose slope was beyond max_slope
  double lambda = 0;
};

struct Imported {
  Texels texels;
  double depth_fraction = 0.02;  // full depth (texel depth 1) over the side of the tile
  ImportReport report;
  std::vector<std::string> notes, warnings;  // one line each
};

// `path` is an image, a folder of images, or a name that find_recipe (recipes/builtin.h) knows: a built-in
// material or a recipe file, whose texture is generated at `generated_size` and is consistent as it is.
//   RGBA image   normals in RGB, depth or height in alpha; a colour map next to it is found by its name
//   RGB image    normals if it looks like normals (a height map next to it is found by its name), else its
//                brightness is taken as height
//   grey image   height
//   folder       searched for normal, height and colour by the usual names
Result<Imported> import_texture(const std::filesystem::path& path, const ImportOptions& options);

// Converts generated images with the same pixel conversion.
Texels to_texels(const TextureImages& images);

// The maps of a texture. Any may be empty, but not both normal and height.
struct TextureFiles {
  std::filesystem::path normal, height, colour;
};

// Finds the maps of a texture by file name. `path` is a folder, searched by the usual names (nor_gl,
// NormalDX, disp, height, diff, Color, ...; an image whose name claims no role is the colour map), or one
// image. A single image is returned in `normal`; the caller classifies it by its pixels. The height and
// colour maps next to it under the same base name are found as well.
Result<TextureFiles> find_texture_files(const std::filesystem::path& path);

// Whether a normal map's file name says that its green channel is -Y (DirectX).
bool name_says_directx(const std::filesystem::path& path);

// Writes an imported texture as the two files that `--surface` reads: `folder`/relief.png (16-bit RGBA:
// normals +Y in RGB, depth in alpha, 0 = top; RGB without depth) and `folder`/color.png. Reading them back
// detects the same conventions and the same full depth. Both appear together, or the old ones stay.
Result<void> write_texture_files(const Imported& imported, const std::filesystem::path& folder);

}  // namespace intaglio::surface
