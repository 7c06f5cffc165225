// Meshes made by turning a profile about +Z: the unit sphere and the pen. Pure functions, no OpenGL; metres,
// outward normals, counter-clockwise triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

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

}  // namespace intaglio::render
