// Triangles for the renderer: bodies turned on a lathe (sphere, pen), a relief as a displaced mesh, and the
// tetrahedra of a curved relief. Pure functions, no OpenGL; metres, outward normals, counter-clockwise.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "mesh/triangle_mesh.h"
#include "surface/surface.h"

namespace intaglio::render {

struct Vertex {
  std::array<float, 3> position;
  std::array<float, 3> normal;
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // three a triangle
};

// Surfaces of revolution about +Z.

// A point of a profile in the half plane (radius, z) with its outward normal; repeat a point to make a
// crease.
struct ProfilePoint {
  double radius, z;
  double normal_radius, normal_z;
};

// The surface of revolution of a profile that goes from low z to high z, with `slices` meridians.
Mesh lathe(std::span<const ProfilePoint> profile, int slices);

// The sphere of radius 1 about the origin; silhouette error at most 1 - cos(pi / slices).
Mesh unit_sphere(int slices = 96);

// Length of a pen's cone, in pen radii.
inline constexpr double pen_tip_radii = 5.0;

// A pen standing on its tip at the origin: a cone of length pen_tip_radii * radius, then the shaft to z =
// length.
Mesh pen_mesh(double length, double radius, int slices = 48);

// A textured slab as a displaced mesh, drawn instead of ray-traced relief, for comparison.
//
// Samples the relief on a grid of `cells` x `cells` squares, two triangles each, and closes it with walls
// down to z = -slab and a floor. Positions are in the local frame, normals are the surface's. With cells = 2
// x texels every texel centre is a vertex. Costs 24 bytes per vertex, 24 per square, and about 0.2 us per
// square.
Mesh slab_mesh(const surface::Surface& surface, int cells, double slab);

// The layer between a curved base and the bottom of its relief, as tetrahedra: within each one the mapping
// from world to texture is affine, so that a straight view ray is straight in the texture, too (Porumbescu et
// al. 2005, "Shell maps"). Read by shaders/shell.vert.

// Counter-clockwise: corner 3 lies on the side to which the normal of corners 0, 1, 2 points.
struct Tetrahedron {
  std::array<std::array<float, 3>, 4> corner;   // world, metres
  std::array<std::array<float, 3>, 4> texture;  // u size_u, v size_v, height: metres
};

// Three tetrahedra for each triangle of `base`, which is `checked`; `depth` metres deep, `size` the rectangle
// that texture coordinates are measured in. Fails when a triangle spans the edge of a repeated texture: the
// mesh must be split there.
//
// The layer's bottom is flat between the vertices, where the base's curved normals (MeshPlacement) would make
// it round. Over an edge of length e on a base of curvature radius R unit normals turn by e / R, and the
// linear blend of two of them has length cos(e / 2R) ~ 1 - (e / R)^2 / 8 in the middle: the layer is too thin
// there by about depth (e / R)^2 / 8. Where the layer folds (depth beyond R) its tetrahedra overlap.
Result<std::vector<Tetrahedron>> shell_tetrahedra(const surface::TriangleMesh& base, double depth,
                                                  const Vec2& size, const std::string& name = "base");

}  // namespace intaglio::render
