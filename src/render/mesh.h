// Meshes made by turning a profile about +Z: the unit sphere and the pen. Pure functions, no OpenGL; metres,
// outward normals, counter-clockwise triangles.
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

// A point of a profile in the half plane (radius, z) with its outward normal; a crease is the same point
// twice.
struct ProfilePoint {
  double radius, z;
  double normal_radius, normal_z;
};

// The surface of revolution of a profile that goes from low z to high z, with `slices` meridians.
Mesh lathe(std::span<const ProfilePoint> profile, int slices);

// The sphere of radius 1 about the origin; its outline is within 1 - cos(pi / slices) of round.
Mesh unit_sphere(int slices = 96);

// How long the cone of a pen is, in pen radii.
inline constexpr double pen_tip_radii = 5.0;

// A pen that stands on its tip: tip at the origin, a cone of pen_tip_radii * radius, then the shaft, up to z
// = length.
Mesh pen(double length, double radius, int slices = 48);

// A textured slab as triangles: what is drawn in place of traced relief, to compare them. Pure; no OpenGL.

// The relief sampled at `cells` x `cells` squares, two triangles each, cut walls down to z = -slab and a
// floor; local frame, metres, normals those of the surface. Where `cells` is twice the texels, every texel is
// a corner. Closed and outward. 24 bytes a corner and 24 a square; cost about 0.2 us a square.
Mesh slab_mesh(const surface::Surface& surface, int cells, double slab);

// The layer between a curved base and the bottom of its relief, as tetrahedra: within each, world and texture
// are affine to each other, so that a straight view ray is straight in the texture too (Porumbescu et al.
// 2005, "Shell maps"). Pure; no OpenGL. Read by shaders/shell.vert.

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
