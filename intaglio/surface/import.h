// From a user's images to the canonical texels of a Surface: unit normals, +Y; depth fraction, 0 = top; row 0 = v 0.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/surface/brick.h"
#include "intaglio/surface/surface.h"

namespace intaglio::surface {

enum class Green { plus_y, minus_y };
enum class Polarity { depth, height };  // what white means: deep, or high

struct ImportOptions {
  std::optional<Green> green;        // unset: minus_y when the file's name says so (NormalDX), else plus_y
  std::optional<Polarity> polarity;  // unset: height for a height map of its own; depth for an alpha channel (the paper's convention)
  double depth_fraction = 0.02;      // full depth over the side of the tile, for normals that are made from depth alone
};

struct Imported {
  Texels texels;
  std::vector<std::string> notes;  // what was found and assumed, one line each
};

// `path` is an image or a folder of images.
//   RGBA image       normals in RGB, depth or height in alpha; a colour map beside it is found by its name
//   RGB image        normals if it looks like normals, else its brightness is taken as height
//   grey image       height
//   folder           searched for normal, height and colour by the usual names (nor_gl, NormalDX, disp, height, diff, Color, ...)
Result<Imported> import_texture(const std::filesystem::path& path, const ImportOptions& options);

// The built-in images, through the same conversion.
Texels to_texels(const TextureImages& images);

}  // namespace intaglio::surface
