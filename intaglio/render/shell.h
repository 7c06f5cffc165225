// The layer between a curved base and the bottom of its relief, as tetrahedra: within each, world and texture
// are affine to each other, so that a straight view ray is straight in the texture too (Porumbescu et al.
// 2005, "Shell maps"). Pure; no OpenGL. Read by shaders/shell.vert.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/surface/mesh/triangle_mesh.h"

namespace intaglio::render {

// Counter-clockwise: corner 3 lies where the normal of corners 0, 1, 2 points.
struct Tetrahedron {
  std::array<std::array<float, 3>, 4> corner;   // world, metres
  std::array<std::array<float, 3>, 4> texture;  // u size_u, v size_v, height: metres
};

// Three for each triangle of `base`, which is `checked`; `depth` metres deep, `size` the rectangle that the
// texture is measured in. What is affine is the layer of each triangle: against the base's curved normals
// (MeshPlacement) it is off by about depth x (edge / radius)^2 / 8. Where the layer folds it is turned inside
// out and not drawn. Fails where a triangle reaches over the edge of a repeated texture: its edges must lie
// on such edges.
Result<std::vector<Tetrahedron>> make_shell(const surface::TriangleMesh& base, double depth, const Vec2& size,
                                            const std::string& name = "base");

}  // namespace intaglio::render
