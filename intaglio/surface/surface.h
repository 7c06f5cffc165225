// A Surface: what one texture says, asked by every sense.
//
// Immutable after construction and safe to ask from any thread; no query allocates. Depth is in metres below the base
// plane, 0 = top, as in the paper's alpha channel (§1.2.1); normals are unit vectors of the tangent frame (t, b, n), +Y up
// the image. Texels are samples at texel centres; between them depth is bilinear, so the relief is a field of bilinear
// patches ("cells") whose corners are texel centres. Outside 0..1 the texture repeats (wrap) or its border goes on (clamp).
// Cost: a sample reads four texels, about 20 ns when they are in cache.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "intaglio/core/image.h"
#include "intaglio/core/vec.h"
#include "intaglio/surface/placement.h"

namespace intaglio::surface {

enum class Edge { wrap, clamp };

// The canonical texels of a surface. Row 0 is v = 0, the *bottom* of the image; import flips.
struct Texels {
  int width = 0;
  int height = 0;
  std::vector<float> depth;     // width x height, fraction of max_depth in 0..1, 0 = top; empty when only normals are known
  std::vector<Vec3> normal;     // width x height, unit, +Y, n_z > 0
  Image8 colour;                // RGB, any size, row 0 = bottom as well
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

class Surface {
 public:
  // `max_depth` in metres is what a texel depth of 1 means.
  Surface(Texels texels, const Placement& placement, double max_depth, Edge edge);

  const Placement& placement() const { return placement_; }
  int width() const { return width_; }
  int height() const { return height_; }
  bool has_depth() const { return !depth_.empty(); }
  double max_depth() const { return max_depth_; }
  Edge edge() const { return edge_; }
  // Distance between texels, metres.
  double texel_u() const { return placement_.size_u() / width_; }
  double texel_v() const { return placement_.size_v() / height_; }
  std::size_t memory_bytes() const;

  // Depth below the base plane at uv, metres (bilinear). 0 where there is no depth map.
  double depth(const Vec2& uv) const;
  // Normal of the map at uv, unit, tangent frame: bilinear over the four nearest texels, then normalised (§1.2.4).
  Vec3 normal(const Vec2& uv) const;
  // Normal of the texel nearest to uv (Eq. 1.4 asks for the nearest one).
  Vec3 texel_normal(const Vec2& uv) const;
  // Gradient of the height (= -depth) in local metres: (dz/dx, dz/dy) of the patch under uv.
  Vec2 gradient(const Vec2& uv) const;

  // World-frame normal of the map.
  Vec3 world_normal(const Vec2& uv) const { return placement_.direction_to_world(normal(uv)); }

  // Height z = -depth of texel (i, j), metres; i, j any integer (wrapped or clamped).
  double texel_z(int i, int j) const { return has_depth() ? -max_depth_ * static_cast<double>(depth_[index(i, j)]) : 0.0; }
  // Cell whose lower corner is texel (i, j).
  Cell cell(int i, int j) const;
  // The cell that holds local (x, y).
  std::pair<int, int> cell_at(double x, double y) const;

  // What the shader mirrors: depth fractions (1 channel) and tangent normals (3 channels), row 0 = v 0.
  std::vector<float> depth_texture() const { return depth_; }
  std::vector<float> normal_texture() const;
  const Image8& colour() const { return colour_; }

 private:
  struct Packed {
    std::int16_t x, y;  // of the unit normal, times 32767; z > 0 follows
  };

  int wrapped(int i, int n) const {
    if (static_cast<unsigned>(i) < static_cast<unsigned>(n)) return i;
    if (edge_ == Edge::clamp) return i < 0 ? 0 : n - 1;
    const int m = i % n;
    return m < 0 ? m + n : m;
  }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(wrapped(j, height_)) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(wrapped(i, width_));
  }
  Vec3 unpacked(int i, int j) const;

  Placement placement_;
  int width_, height_;
  double max_depth_;
  Edge edge_;
  std::vector<float> depth_;
  std::vector<Packed> normal_;
  Image8 colour_;
};

}  // namespace intaglio::surface
