// A Surface answers every query about one texture: depth, normal, gradient, colour.
//
// Immutable after construction; any thread; no query allocates. Depth is in metres below the base plane, 0 =
// top, as in the paper's alpha channel (§1.2.1); normals are unit vectors of the tangent frame (t, b, n), +Y
// up the image. Texels are samples at texel centres; between them depth is bilinear, so the relief is a field
// of bilinear patches ("cells") whose corners are texel centres. Outside 0..1 the texture repeats (wrap) or
// its border texels extend outwards (clamp).
//
// Three ways to read it. `depth`, `normal`, `gradient`: the texels as they are. `sample`: what a body, tip or
// pixel of a given diameter can resolve, from mip levels (texels.h). `smooth`: a C1 height with its exact
// gradient, for forces that must derive from a potential. Cost: 0.05 to 0.1 us with texels in cache, plus a
// few cache misses otherwise. Rays, nearest points and bounds have queries of their own (ray.h, closest.h,
// height_range below) on the pyramid. Memory: 11.7 bytes a texel (2.9 MiB at 512 x 512), and the colour
// image.
//
// Three frames are used for a textured rectangle:
//   uv      (u, v) in 0..1; u to the right of the image, v up the image (v = 0 is the bottom row)
//   local   (x, y, z) in metres along (t, b, n), from the corner u = v = 0; z = 0 is the base plane and the
//           relief is at z = -depth
//   world   metres
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "intaglio/image.h"
#include "intaglio/vec.h"
#include "surface/pyramid.h"
#include "surface/texels.h"

namespace intaglio::surface {

// The rectangle that a texture covers in the world.
class Placement {
 public:
  // A rectangle of size_u x size_v metres centred at `centre`. With the identity as `orientation` it is
  // horizontal: t = +X, b = -Z, n = +Y.
  Placement(const Vec3& centre, const Quat& orientation, double size_u, double size_v)
      : size_u_(size_u), size_v_(size_v) {
    axes_.col(0) = orientation * Vec3::UnitX();
    axes_.col(1) = orientation * -Vec3::UnitZ();
    axes_.col(2) = orientation * Vec3::UnitY();
    corner_ = centre - 0.5 * size_u * t() - 0.5 * size_v * b();
  }

  double size_u() const { return size_u_; }
  double size_v() const { return size_v_; }
  Vec2 size() const { return {size_u_, size_v_}; }
  Vec3 t() const { return axes_.col(0); }
  Vec3 b() const { return axes_.col(1); }
  Vec3 n() const { return axes_.col(2); }

  Vec3 to_local(const Vec3& world) const { return axes_.transpose() * (world - corner_); }
  Vec3 to_world(const Vec3& local) const { return corner_ + axes_ * local; }
  Vec3 direction_to_local(const Vec3& world) const { return axes_.transpose() * world; }
  Vec3 direction_to_world(const Vec3& local) const { return axes_ * local; }
  Vec2 uv(const Vec3& local) const { return {local.x() / size_u_, local.y() / size_v_}; }
  // Whether a local point is above or below the rectangle, enlarged by `slack` metres on all sides.
  bool covers(const Vec3& local, double slack = 0) const {
    return local.x() >= -slack && local.x() <= size_u_ + slack && local.y() >= -slack &&
           local.y() <= size_v_ + slack;
  }

 private:
  double size_u_, size_v_;
  Mat3 axes_;  // columns t, b, n
  Vec3 corner_;
};

// The input of a Surface. Row 0 is v = 0, the *bottom* of the image; import flips.
struct Texels {
  int width = 0;
  int height = 0;
  // width x height, fraction of max_depth in 0..1, 0 = top; empty when only normals are known.
  std::vector<float> depth;
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
  // Change of the slope across the cell: 0 for a parallelogram.
  double twist() const { return z[3] - z[2] - z[1] + z[0]; }
  // Derivatives of z by s at t, and by t at s.
  double z_s(double t) const { return (z[1] - z[0]) + t * twist(); }
  double z_t(double s) const { return (z[2] - z[0]) + s * twist(); }
  // The point of the patch at (s, t) in 0..1.
  Vec3 at(double s, double t) const {
    const double low = z[0] + s * (z[1] - z[0]);
    const double high = z[2] + s * (z[3] - z[2]);
    return {x0 + s * width(), y0 + t * height(), low + t * (high - low)};
  }
  // Upward unit normal of the patch at (s, t).
  Vec3 normal(double s, double t) const {
    return Vec3(-z_s(t) / width(), -z_t(s) / height(), 1.0).normalized();
  }
};

// The surface averaged over a footprint.
struct Sample {
  double depth;      // metres below the base plane
  Vec3 normal;       // unit, tangent frame, of the normal map
  Vec2 gradient;     // (dz/dx, dz/dy) of the height -depth, local metres
  double roughness;  // root mean square of the slope lost by averaging; 0 at footprint 0
};

// A C1 height and its exact gradient.
struct SmoothHeight {
  double height;  // z = -depth, metres
  Vec2 gradient;  // (dz/dx, dz/dy), the derivative of `height`
};

class Surface {
 public:
  // `max_depth` is the depth in metres of a texel depth of 1.
  Surface(Texels texels, const Placement& placement, double max_depth, Edge edge);
  // The same texels, which both share, on another rectangle.
  Surface placed(const Placement& placement, double max_depth) const;

  const Placement& placement() const { return placement_; }
  int width() const { return grid_.width; }
  int height() const { return grid_.height; }
  bool has_depth() const { return has_depth_; }
  // The relief is the plane z = 0.
  bool is_flat() const { return !has_depth_ || max_depth_ == 0; }
  double max_depth() const { return max_depth_; }
  Edge edge() const { return grid_.edge; }
  // Distance between texels, metres.
  double texel_u() const { return placement_.size_u() / grid_.width; }
  double texel_v() const { return placement_.size_v() / grid_.height; }
  std::size_t memory_bytes() const;

  // Depth below the base plane at uv, metres (bilinear). 0 without a depth map.
  double depth(const Vec2& uv) const;
  // Normal of the map at uv, unit, tangent frame: bilinear over the four nearest texels, then normalised
  // (§1.2.4).
  Vec3 normal(const Vec2& uv) const;
  // Normal of the texel nearest to uv (Eq. 1.4 uses the nearest texel).
  Vec3 texel_normal(const Vec2& uv) const;
  // Gradient of the height (= -depth) in local metres: (dz/dx, dz/dy) of the patch under uv.
  Vec2 gradient(const Vec2& uv) const;

  // At a footprint: the diameter in metres over which the surface is averaged; up to one texel nothing is
  // averaged. Between two mip levels the results are interpolated. `sample` at footprint 0 is depth, normal
  // and gradient above; averaged slopes are limited to max_slope. `smooth` interpolates the texels
  // (Catmull-Rom bicubic). Its negative weights add up to 9/32 in the middle of a cell, so it may overshoot
  // the nearest 4 x 4 texels by 9/32 of their spread, also above the base plane.
  Sample sample(const Vec2& uv, double footprint = 0) const;
  SmoothHeight smooth(const Vec2& uv, double footprint = 0) const;

  // World-frame normal of the map.
  Vec3 world_normal(const Vec2& uv) const { return placement_.direction_to_world(normal(uv)); }

  // Height z = -depth of texel (i, j), metres; i, j any integer (wrapped or clamped).
  double texel_z(int i, int j) const { return -max_depth_ * double(tiles().depth(tiles().index(i, j))); }
  // The cell whose lower corner is texel (i, j).
  Cell cell(int i, int j) const;
  // The cell that contains local (x, y).
  std::pair<int, int> cell_at(double x, double y) const;

  const Grid& grid() const { return grid_; }
  const Pyramid& pyramid() const { return contents_->pyramid; }
  const Mips& mips() const { return contents_->mips; }
  const TexelTiles& tiles() const { return contents_->tiles; }
  // Equal for surfaces that share their texels.
  const void* identity() const { return contents_.get(); }

  // Data for the shader's textures: depth fractions (1 channel; empty without a depth map) and tangent
  // normals (3 channels), row 0 = v 0.
  std::vector<float> depth_texture() const;
  std::vector<float> normal_texture() const;
  const Image8& colour() const { return contents_->colour; }

 private:
  Vec3 normal_of_texel(int i, int j) const { return tiles().normal(tiles().index(i, j)).unit(); }
  BilinearTaps taps(const Vec2& uv) const;
  double depth_at(const BilinearTaps& at) const;
  Vec3 normal_at(const BilinearTaps& at) const;
  Vec2 gradient_at(const BilinearTaps& at) const;
  // Quantities that blend linearly between two mip levels. Normals and roughness do not, so they are derived
  // afterwards.
  struct Moments {
    double depth;
    Vec2 gradient, slope;
    double variance;
  };
  Moments moments_at(int level, const Vec2& uv) const;
  SmoothHeight smooth_at_level(int level, const Vec2& uv) const;

  // All that does not depend on the rectangle.
  struct Contents {
    TexelTiles tiles;
    Pyramid pyramid;
    Mips mips;
    Image8 colour;
  };

  Placement placement_;
  Grid grid_;
  double texels_per_metre_ = 0;  // 1 / (distance between texels), the geometric mean of both axes
  double max_depth_;
  bool has_depth_;
  std::shared_ptr<const Contents> contents_;
};

struct HeightRange {
  double low = 0, high = 0;  // z in metres, local: low <= high <= 0
};

// Lowest and highest point of the relief over the rectangle of uv with these corners, in any order; a
// degenerate rectangle is a point. It may extend beyond 0..1. Non-finite input returns the range of the whole
// relief.
//
// Exact: over a rectangle, a bilinear patch has its extremes at the corners, and blocks inside the rectangle
// are answered from the pyramid. Cost: proportional to the outline of the rectangle in cells; 3 us for 10 x
// 10 cells.
HeightRange height_range(const Surface& surface, const Vec2& uv_a, const Vec2& uv_b);

}  // namespace intaglio::surface
