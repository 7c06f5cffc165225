// Meshes of the brick at several levels of detail (§1.4.4.2 of Sterling & Lin 2016), and its texture at
// several resolutions.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "intaglio/vec.h"
#include "surface/surface.h"

namespace intaglio::bench {

// A part of the full mesh, which has a vertex at every texel: local coordinates of the surface, m.
// Vertices keep the normals of the full mesh.
struct LodMesh {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs;
  std::vector<std::array<int, 3>> triangles;

  // 32 a vertex, 12 a triangle.
  double bytes() const { return 32.0 * double(positions.size()) + 12.0 * double(triangles.size()); }
};

// By which error a mesh is simplified. meshoptimizer collapses edges by the squared distance to the planes of
// a surface (Garland & Heckbert 1997), and the vertices that are left keep the heights of the relief.
enum class LodMetric {
  geometry,  // that surface is the relief itself
  shading,   // the relief less its mean over 4 texels, four times as high: light shows fine slopes
  heights,   // the relief twice as high: errors of height count more than errors sideways
  contact,   // the relief as far as a ball of 0.1 m reaches (its closing, texel by texel); so are the heights
  grid,      // none: every 2nd, 3rd, ... texel is kept
};
std::string name_of(LodMetric metric);

class LodChain {
 public:
  explicit LodChain(const surface::Surface& full);

  // About `share` of the full mesh's triangles, in 0..1.
  LodMesh mesh(LodMetric metric, double share) const;
  std::size_t full_triangles() const { return indices_.size() / 3; }

 private:
  LodMesh part(const std::vector<unsigned>& indices, LodMetric metric) const;
  std::vector<unsigned> grid(double share) const;

  int side_;
  LodMesh all_;
  std::vector<unsigned> indices_;
  std::array<std::vector<float>, 4>
      metric_positions_;  // one list a LodMetric except `grid`; three values a vertex
};

// The same texture with `size` texels a side, a power of two below the full one's: means of blocks.
std::shared_ptr<const surface::Surface> reduced(const surface::Surface& full, int size);

}  // namespace intaglio::bench
