// Pictures of textured surfaces, drawn headless or into a window: relief mapping with self-occlusion,
// self-shadow, cut silhouettes and true depth (Policarpo, Oliveira & Comba 2005; §1.2.1), with balls, other
// solids and a pen in the same depth buffer and light.
//
// The shaders mirror surface::Surface: same texel centres, same bilinear patches, same edge rule; tests hold
// the two together. A surface is drawn as a slab on the rectangle of its placement, with walls where the
// relief is cut, or as relief on a curved base.
//
// Thread: any, one at a time. Each renderer owns a GL context, current only during a call, unless it is given
// Context::current. Deterministic: the same driver, surface and scene give the same bytes. Cost: about 0.2
// CPU-seconds for a frame of 640 x 360 with supersample 2 on llvmpipe, and 0.2 to create.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/image.h"
#include "mesh/triangle_mesh.h"
#include "render/frame_scene.h"
#include "surface/surface.h"

namespace intaglio::render {

// How a view ray finds the relief: the paper's linear and binary search, or the exact one through the
// pyramid.
enum class March { classic, pyramid };

// How relief smaller than a sample is filtered: by the mean over the sample's footprint, as colours and
// normals are (surface_textures.h), or not at all: a sample sees the texel in its middle. Only comparisons
// with brute force want the latter. Where texels are larger than samples the two are the same.
enum class Detail { by_footprint, every_texel };

// Which OpenGL 3.3 core context the renderer uses.
enum class Context {
  own,      // one without a window (egl_context.h)
  current,  // the caller's, which must be current at every call and at destruction
};

// One textured surface.
struct SurfacePart {
  const surface::Surface* surface = nullptr;  // uploaded by the call that takes this
  double slab_thickness = 0.03;               // m; at least 1.25 times the relief's depth is drawn
  double roughness = 0.55;                    // 0..1 (GGX: alpha is its square)
  // Not null: the relief lies on this curved base, which is `checked`; the surface's rectangle then only sets
  // the metric size of u and v, and FrameScene::part_poses moves the part. Uploaded by the call that takes
  // this.
  const surface::TriangleMesh* base = nullptr;
  // Over 0: relief is drawn as a displaced mesh of so many squares a side, for comparison.
  int displaced_mesh_cells = 0;
};

struct RendererOptions {
  int width = 1280;
  int height = 720;
  int supersample = 2;  // samples along a pixel's side, 1..4
  March march = March::pyramid;
  Detail detail = Detail::by_footprint;
  int linear_steps = 32;  // classic: linear steps
  int binary_steps = 6;   // classic: bisections after them
  int shadow_steps = 32;  // maximum steps of the self-shadow, which takes one a texel; 0: no self-shadow
  double slab_thickness = 0.03;          // of the first surface: see SurfacePart
  double roughness = 0.55;               // likewise
  int displaced_mesh_cells = 0;          // likewise
  Vec3 colour = Vec3(0.45, 0.44, 0.42);  // of surfaces without a colour map; linear RGB
  Context context = Context::own;
};

class Renderer {
 public:
  // Uploads the surface; it need not outlive the call. Fails without EGL or OpenGL 3.3, with options out of
  // range, or when a texture or picture is larger than the driver allows.
  static Result<std::unique_ptr<Renderer>> create(const surface::Surface& surface,
                                                  const RendererOptions& options);
  ~Renderer();

  // Replaces the surfaces; at least one. Bodies cast shadows on all of them, and receive the relief's shadow
  // from the first. On failure the previous surfaces remain.
  Result<void> show(std::span<const SurfacePart> parts);
  // Uses the shaders of a folder from now on, and the built-in ones for those it lacks. If one does not
  // compile, the error names its file and line, and the previous shaders remain.
  Result<void> reload_shaders(const std::filesystem::path& folder);
  // Changes the size of pictures; on failure it stays as it was.
  Result<void> resize(int width, int height);

  // The picture: sRGB, 3 channels, row 0 at the top.
  Image8 draw(const FrameScene& scene);
  // Draws into the lower left width x height pixels of a framebuffer of the context (0: the window), scaled
  // if the picture has another size. Leaves that framebuffer bound, with nothing enabled.
  void draw_to(const FrameScene& scene, unsigned framebuffer, int width, int height);
  // The last picture at another size: for recordings whose size is fixed while the window is resized.
  Result<Image8> capture(int width, int height);

  // Linear depth of the last draw, width x height, row 0 at the top: metres from the eye along the camera's
  // axis (not along the pixel's ray), infinity on the background. A pixel has the depth of its middle sample;
  // for an even supersample, of the sample above and right of the centre.
  std::vector<float> depth() const;

  // GPU memory used by the surfaces; colour maps count as textures.
  struct DeviceBytes {
    std::size_t textures = 0, meshes = 0;
  };
  DeviceBytes device_bytes() const;

  // The driver, for logs and reports.
  std::string device() const;

 private:
  struct Gpu;
  explicit Renderer(std::unique_ptr<Gpu> gpu);

  std::unique_ptr<Gpu> gpu_;
};

}  // namespace intaglio::render
