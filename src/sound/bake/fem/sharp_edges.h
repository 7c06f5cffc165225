// The sharp edges of a body's surface, where two faces meet at more than 30 degrees, and the corners where
// edges meet or bend.
//
// Immutable, any thread. Cost: a sort of the sides of all triangles; a query tests a few segments.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "sound/bake/fem/body_surface.h"
#include "sound/bake/fem/tet_mesh.h"

namespace intaglio::sound {

struct SharpEdge {
  int from, to;      // points of the body
  Vec3 left, right;  // normals of its faces
};
std::vector<SharpEdge> find_sharp_edges(const BodySurface& body);
double total_length(const std::vector<SharpEdge>& edges, const BodySurface& body);

class SharpEdges {
 public:
  // Queries reach no farther than `reach`, metres.
  SharpEdges(const BodySurface& body, const std::vector<SharpEdge>& edges, double reach);

  const std::vector<Vec3>& corners() const { return corners_; }
  // The nearest point of an edge, if it is nearer than `within`.
  std::optional<Vec3> nearest(const Vec3& p, double within) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct HashOf {
    std::size_t operator()(const Cell& c) const {
      return std::size_t((c[0] * 73'856'093) ^ (c[1] * 19'349'663) ^ (c[2] * 83'492'791));
    }
  };
  Cell cell_of(const Vec3& p) const;
  void find_corners(const BodySurface& body, const std::vector<SharpEdge>& edges);

  double cell_;
  std::vector<std::array<Vec3, 2>> segments_;
  std::unordered_map<Cell, std::vector<int>, HashOf> in_cell_;
  std::vector<Vec3> corners_;
};

// Restores sharp edges that a lattice cuts off, which would cost a body several per cent of pitch.
//
// Points of the boundary near a corner move onto it, those near an edge onto that; edges of elements that
// still cut a sharp edge off are split where it passes. Each step is taken only if every element it touches
// stays well shaped, so it cannot fail; edges that cannot be restored stay cut off. Cost: some milliseconds
// for 5,000 elements.

// `cell`: size of a lattice cell, m.
void keep_edges(CornerMesh& mesh, const SharpEdges& edges, const SurfaceQuery& surface, double cell);

}  // namespace intaglio::sound
