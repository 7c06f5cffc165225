// Statistics of a texture: its conventions, depth, slopes, terraces, whether its normals fit a height, and
// which representation suits it.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "surface/import.h"

namespace intaglio::surface {

struct Inspection {
  int width = 0, height = 0;
  bool has_normals = false, has_height = false;
  ImportReport report;
  double depth_fraction = 0;  // full depth over the side

  // Slopes of the imported surface, in degrees from the base plane.
  static constexpr int bin_degrees = 5;
  std::array<double, 90 / bin_degrees> slope_histogram{};  // fractions of the texels
  double rms_slope = 0;
  double steep_fraction = 0;          // above 45 degrees
  double near_vertical_fraction = 0;  // above 70 degrees

  // Terraces of the height file: the number of levels it uses, and the slope of one level over one texel; a
  // gentler ramp is quantised into steps.
  int height_levels = 0;
  double terrace_slope = 0;

  std::string representation;  // "relief", "normal" or "flat"
  std::string reason;          // one sentence

  Image8 colour, height_map, normal_map, preview;  // previews: RGB, row 0 = top, at most 512 wide
  std::vector<std::string> notes, warnings;
};

// Imports the texture and measures it.
Result<Inspection> inspect(const std::filesystem::path& path, const ImportOptions& options);

// The coloured surface lit from the upper left, which shows its slopes. RGB, row 0 = top.
Image8 relit_preview(const Texels& texels, int width);

}  // namespace intaglio::surface
