// A textured surface: what an image says about height and slope, in metres, on a rectangle in the world.
//
//   auto wall = intaglio::Surface::load("my_wall/", {.size = {4, 4}});
//   if (!wall) { std::cerr << wall.error() << '\n'; return 1; }
//   auto hit = wall->ray({0, 1, 0}, {0.3, -1, 0.1});          // examples/texture_report.cpp
//
// A Surface is a handle to immutable data: copies are cheap and share it, and every function may be called
// from any thread at the same time. Queries do not allocate. They cost 0.05 to 0.1 us a sample, 1 to 2 us a
// ray or closest point at 512 x 512 texels, three times that at 4096 x 4096. Memory: 12 bytes a texel.
//
// Lengths are metres. uv is 0..1, u to the right of the image, v up it (v = 0 is the bottom row); outside,
// the texture repeats or its border goes on. By default the rectangle lies flat about the origin: u along +X,
// v along -Z, normal +Y. Relief only cuts in: heights are 0 at the top and negative below. A slope is (dz/dx,
// dz/dy), metres per metre along u and v.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/image.h"
#include "intaglio/material.h"
#include "intaglio/memory.h"
#include "intaglio/vec.h"

namespace intaglio {

enum class Edge { wrap, clamp };              // beyond uv 0..1 the texture repeats, or its border goes on
enum class GreenChannel { plus_y, minus_y };  // of a normal map: OpenGL's and glTF's way, or DirectX's
enum class WhiteMeans { deep, high };         // of a depth or height map
enum class ImportMode {
  fused,  // height and normals become one consistent field; normals alone are integrated to an implied height
  raw,    // the maps as they are, as in Sterling & Lin 2016: normals need not be those of the height
};

struct SurfaceOptions {
  Vec2 size = Vec2(1, 1);  // m, of the whole texture along u and v
  Pose pose = {};          // of the rectangle: its centre, and how it is turned from lying flat
  // m, from the highest to the lowest texel; unset: what the texture implies.
  std::optional<double> depth = {};
  Edge edge = Edge::wrap;
  ImportMode mode = ImportMode::fused;
  // Unset: detected from the images, else by the file's name, else +Y and high.
  std::optional<GreenChannel> green = {};
  std::optional<WhiteMeans> white = {};
  int generated_size = 512;  // texels a side of a built-in texture or recipe; an error outside 64 to 8192
  std::uint64_t allowed_memory = default_allowed_memory;  // bytes; images that need more are an error
};

// The surface as a probe of a given footprint meets it.
struct SurfaceSample {
  double height = 0;            // m, <= 0
  Vec3 normal = Vec3::UnitZ();  // unit, of the normal map, in the tangent frame (t, b, n)
  Vec2 slope = Vec2::Zero();    // of the height
  double roughness = 0;         // root mean square of the slope that the footprint hides; 0 at footprint 0
};

// A height that can be differentiated everywhere, for forces that come from a potential.
struct SmoothHeight {
  double height = 0;
  Vec2 slope = Vec2::Zero();  // the exact derivative of `height`, continuous everywhere
};

struct RayHit {
  double t = 0;                 // point = origin + t * direction
  Vec3 point = Vec3::Zero();    // world
  Vec3 normal = Vec3::UnitY();  // unit, world, of the relief there
  Vec2 uv = Vec2::Zero();
};

struct ClosestPoint {
  double distance = 0;          // m, signed: negative below the relief
  Vec3 point = Vec3::Zero();    // world, on the relief
  Vec3 normal = Vec3::UnitY();  // unit, world, from there outwards along the line to the query point
  Vec2 uv = Vec2::Zero();
};

class Surface {
 public:
  // `texture` is a built-in name ("brick"; builtin_textures() lists them), a recipe (.toml,
  // docs/materials.md), an image, or a folder that is searched for normal, height and colour maps by their
  // usual names (PNG, JPEG, TGA, EXR). Errors name the file and what would be right. 0.1 to 0.5 s at 512 x
  // 512.
  static Result<Surface> load(const std::filesystem::path& texture, const SurfaceOptions& options = {});

  // From heights in metres, row by row from v = 0 (the bottom of an image), width x height of them; the
  // highest becomes 0. Options that concern images are not used. Errors: sizes that do not fit, numbers that
  // are not finite.
  static Result<Surface> from_heights(int width, int height, std::span<const float> heights,
                                      const SurfaceOptions& options = {});

  // The findings of import: conventions, implied depth, warnings; a line each. notes() and warnings() are its
  // parts. Empty for built-in textures, recipes and from_heights(), which leave nothing to find.
  std::string import_report() const;
  const std::vector<std::string>& notes() const;
  const std::vector<std::string>& warnings() const;
  // The material of a built-in texture or recipe, else brick.
  const Material& material() const;

  Vec2 size() const;     // m
  Pose pose() const;     // of the rectangle
  double depth() const;  // m, of the deepest that the texture can say
  int texels_u() const;
  int texels_v() const;
  bool has_depth() const;  // false when only normals are known (mode raw)
  Image8 colour() const;   // RGB, row 0 at the bottom; 1 x 1 or empty without a colour map
  std::size_t memory_bytes() const;

  // At uv. `footprint` is the diameter, in metres, of what touches there (a tip, a ball's contact, a pixel):
  // the texture is averaged over it.
  double height(const Vec2& uv, double footprint = 0) const;
  Vec2 slope(const Vec2& uv, double footprint = 0) const;
  Vec3 normal(const Vec2& uv, double footprint = 0) const;  // world, of the normal map
  SurfaceSample sample(const Vec2& uv, double footprint = 0) const;
  SmoothHeight smooth(const Vec2& uv, double footprint = 0) const;

  Vec3 point(const Vec2& uv) const;      // world, on the relief
  Vec2 uv(const Vec3& point) const;      // of the place below or above a world point
  bool covers(const Vec3& point) const;  // whether that is within the rectangle

  // The first point of the relief on a ray, exact, within the rectangle. `direction` of any length but 0.
  std::optional<RayHit> ray(const Vec3& origin, const Vec3& direction,
                            double t_max = std::numeric_limits<double>::infinity()) const;
  // The nearest point of the relief, exact; the relief goes on beyond the rectangle as `edge` says. Absent
  // only when the point is not finite.
  std::optional<ClosestPoint> closest(const Vec3& point) const;

  struct Impl;  // of the library
  explicit Surface(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

// The names of the built-in textures. load() also takes "brick", another name of brick_running.
std::vector<std::string> builtin_textures();

}  // namespace intaglio
