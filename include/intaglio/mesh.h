// A texture on a curved base: a bowl, a pipe, a carved ball, your own mesh.
//
//   using namespace intaglio;
//   auto bowl = CurvedSurface::load("pebbles", repeated(bowl_mesh(1), {4, 1}), {.depth = 0.01});
//   if (!bowl) { std::cerr << bowl.error() << '\n'; return 1; }      // examples/bullet_bowl.cpp
//
// The relief is height = -depth along the interpolated unit normal of the mesh. A handle to immutable data:
// copies are cheap, every function may be called from any thread. docs/curved.md says what curved relief can
// and cannot do, and what it costs. Lengths in metres; the mesh's coordinates are those of the answers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "intaglio/error.h"
#include "intaglio/memory.h"
#include "intaglio/surface.h"
#include "intaglio/triangle_mesh.h"
#include "intaglio/vec.h"

namespace intaglio {

// The mesh of a Wavefront OBJ (.obj), glTF 2.0 (.gltf, .glb) or STL (.stl, shape only) file; files are not
// trusted. Units are taken as metres. Limits: 256 MB, 4 million triangles; a file that would need more than
// `allowed_memory` bytes to read is an error. About 2 s per million triangles.
enum class MeshUse { texture, shape };  // to lay a texture on, or for its shape alone: missing UVs are zero
Result<TriangleMesh> load_mesh(const std::filesystem::path& path, MeshUse use = MeshUse::texture,
                               std::uint64_t allowed_memory = default_allowed_memory);

// Meshes of known shape, with the axis along +Y and the middle at the origin. UVs run once over each.
TriangleMesh quad_mesh(const Vec2& size);                               // lying flat, u along +X, v along -Z
TriangleMesh sphere_mesh(double radius, int around = 96, int up = 48);  // u eastwards, v from pole to pole
TriangleMesh bowl_mesh(double radius, int around = 96, int up = 48);    // the inside of the lower hemisphere
// The side only, without lids.
TriangleMesh cylinder_mesh(double radius, double height, int around = 96, int up = 1);

// The same mesh turned and moved; the same with the texture `times` as often along u and v.
TriangleMesh moved(TriangleMesh mesh, const Pose& pose);
TriangleMesh repeated(TriangleMesh mesh, const Vec2& times);

class CurvedSurface {
 public:
  // The texture as Surface::load takes it; `options.size` and `options.pose` are not used: the mesh's UVs say
  // how large a texture is. Errors: those of the texture; a mesh without triangles or UVs, with indices or
  // numbers out of range; relief so deep that it folds, and then how deep it may be.
  static Result<CurvedSurface> load(const std::filesystem::path& texture, TriangleMesh mesh,
                                    const SurfaceOptions& options = {});

  // The texture on its rectangle, which is the measure of u and v.
  const Surface& surface() const;
  const TriangleMesh& mesh() const;
  Vec3 low() const;  // corners of the box that holds the relief
  Vec3 high() const;
  double fold_depth() const;  // m, the greatest depth that folds nowhere on this mesh; may be infinite

  // Where a texture coordinate is in space; of the first triangle where UVs overlap.
  std::optional<Vec3> point(const Vec2& uv) const;
  // The nearest point of the relief, at most `reach` metres away, exact; its `distance` is negative below.
  std::optional<ClosestPoint> closest(const Vec3& point, double reach) const;

  struct Impl;  // of the library
  explicit CurvedSurface(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace intaglio
