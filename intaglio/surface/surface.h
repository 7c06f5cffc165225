// A Surface: what one texture says, asked by every sense.
//
// Immutable after construction and safe to ask from any thread; no query allocates. Depth is in metres below
// the base plane, 0 = top, as in the paper's alpha channel (§1.2.1); normals are unit vectors of the tangent
// frame (t, b, n), +Y up the image. Texels are samples at texel centres; between them depth is bilinear, so
// the relief is a field of bilinear patches ("cells") whose corners are texel centres. Outside 0..1 the
// texture repeats (wrap) or its border goes on (clamp).
//
// Three ways to read it. `depth`, `normal`, `gradient`: the texels as they are. `sample`: what a body, tip or
// pixel of some diameter can resolve, from mip levels (mips.h). `smooth`: a C1 height with its exact
// gradient, for forces that must come from a potential. Each 0.05 to 0.1 us while the texels are in cache, a
// few misses more where they are not. Hits, nearest points and bounds are queries of their own (ray.h,
// closest.h, extent.h) on the pyramid. Memory: 11.7 bytes a texel (2.9 MiB at 512 x 512), and the colour
// image.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "intaglio/core/image.h"
#include "intaglio/core/vec.h"
#include "intaglio/surface/mip_filter.h"
#include "intaglio/surface/mips.h"
#include "intaglio/surface/placement.h"
#include "intaglio/surface/pyramid.h"
#include "intaglio/surface/texel_tiles.h"

namespace intaglio::surface {

// The canonical texels of a surface. Row 0 is v = 0, the *bottom* of the image; import flips.
struct Texels {
  int width = 0;
  int height = 0;
  std::vector<float>
      depth;  // width x height, fraction of max_depth in 0..1, 0 = top; empty when only normals are known
  std::vector<Vec3> normal;  // width x height, unit, +Y, n_z > 0
  Image8 colour;             // RGB, any size, row 0 = bottom as well
};

// One bilinear patch in local coordinates (metres): corners z[0..3] at (x0,y0), (x1,y0), (x0,y1), (x1,y1).
struct Cell {
  double x0, y0, x1, y1;
  std::array<double, 4> z;

  double max_z() const { return std::max(std::max(z[0], z[1]), std::max(z[2], z[3])); }
  double min_z() const { return std::min(std::min(z[0], z[1]), std::min(z[2], z[3])); }
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
  // The point of the patch at (s, t) in 0..1.
  Vec3 at(double s, double t) const {
    const double low = z[0] + s * (z[1] - z[0]);
    const double high = z[2] + s * (z[3] - z[2]);
    return {x0 + s * width(), y0 + t * height(), low + t * (high - low)};
  }
  // Upward unit normal of the patch at (s, t).
  Vec3 normal(double s, double t) const {
    const double dz_ds = (z[1] - z[0]) + t * (z[3] - z[2] - z[1] + z[0]);
    const double dz_dt = (z[2] - z[0]) + s * (z[3] - z[2] - z[1] + z[0]);
    return Vec3(-dz_ds / width(), -dz_dt / height(), 1.0).normalized();
  }
};

// What a probe of a given footprint meets.
struct Sample {
  double depth;      // metres below the base plane
  Vec3 normal;       // unit, tangent frame, of the normal map
  Vec2 gradient;     // (dz/dx, dz/dy) of the height -depth, local metres
  double roughness;  // root mean square of the slope that the footprint hides; 0 at footprint 0
};

// A height that can be differentiated everywhere.
struct Smooth {
  double height;  // z = -depth, metres
  Vec2 gradient;  // (dz/dx, dz/dy), the exact derivative of `height`, continuous everywhere
};

class Surface {
 public:
  // `max_depth` in metres is what a texel depth of 1 means.
  Surface(Texels texels, const Placement& placement, double max_depth, Edge edge);

  const Placement& placement() const { return placement_; }
  int width() const { return grid_.width; }
  int height() const { return grid_.height; }
  bool has_depth() const { return has_depth_; }
  // Whether the relief is the plane z = 0.
  bool is_flat() const { return !has_depth_ || max_depth_ == 0; }
  double max_depth() const { return max_depth_; }
  Edge edge() const { return grid_.edge; }
  // Distance between texels, metres.
  double texel_u() const { return placement_.size_u() / grid_.width; }
  double texel_v() const { return placement_.size_v() / grid_.height; }
  std::size_t memory_bytes() const;

  // Depth below the base plane at uv, metres (bilinear). 0 where there is no depth map.
  double depth(const Vec2& uv) const;
  // Normal of the map at uv, unit, tangent frame: bilinear over the four nearest texels, then normalised
  // (§1.2.4).
  Vec3 normal(const Vec2& uv) const;
  // Normal of the texel nearest to uv (Eq. 1.4 asks for the nearest one).
  Vec3 texel_normal(const Vec2& uv) const;
  // Gradient of the height (= -depth) in local metres: (dz/dx, dz/dy) of the patch under uv.
  Vec2 gradient(const Vec2& uv) const;

  // Both at a footprint: the diameter in metres over which the surface is averaged; up to one texel there is
  // nothing to average. Between two mip levels they are blended in proportion. `sample` at footprint 0 is
  // depth, normal and gradient above; its slope is limited to steepest_slope when averaged. `smooth` goes
  // through the texels (Catmull-Rom bicubic) and may overshoot them by an eighth of their difference, also
  // above the base plane.
  Sample sample(const Vec2& uv, double footprint = 0) const;
  Smooth smooth(const Vec2& uv, double footprint = 0) const;

  // World-frame normal of the map.
  Vec3 world_normal(const Vec2& uv) const { return placement_.direction_to_world(normal(uv)); }

  // Height z = -depth of texel (i, j), metres; i, j any integer (wrapped or clamped).
  double texel_z(int i, int j) const {
    return -max_depth_ * static_cast<double>(tiles_.depth(tiles_.index(i, j)));
  }
  // Cell whose lower corner is texel (i, j).
  Cell cell(int i, int j) const;
  // The cell that holds local (x, y).
  std::pair<int, int> cell_at(double x, double y) const;

  const Grid& grid() const { return grid_; }
  const Pyramid& pyramid() const { return pyramid_; }
  const Mips& mips() const { return mips_; }
  const TexelTiles& tiles() const { return tiles_; }

  // What the shader mirrors: depth fractions (1 channel) and tangent normals (3 channels), row 0 = v 0.
  // Empty where there is no depth map.
  std::vector<float> depth_texture() const;
  std::vector<float> normal_texture() const;
  const Image8& colour() const { return colour_; }

 private:
  Vec3 unpacked(int i, int j) const { return tiles_.normal(tiles_.index(i, j)).unit(); }
  BilinearTaps taps(const Vec2& uv) const;
  double depth_at(const BilinearTaps& at) const;
  Vec3 normal_at(const BilinearTaps& at) const;
  Vec2 gradient_at(const BilinearTaps& at) const;
  // What two levels are blended from: slopes and variances add, normals and roughness do not.
  struct Averaged {
    double depth;
    Vec2 gradient, slope;
    double variance;
  };
  Averaged averaged(int level, const Vec2& uv) const;
  Smooth smooth_level(int level, const Vec2& uv) const;

  Placement placement_;
  Grid grid_;
  double per_texel_ = 0;  // 1 / (distance between texels), the geometric mean of both axes
  double max_depth_;
  bool has_depth_;
  TexelTiles tiles_;
  Pyramid pyramid_;
  Mips mips_;
  Image8 colour_;
};

}  // namespace intaglio::surface
