#include "render/renderer.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "intaglio/representation.h"
#include "render/egl_context.h"
#include "render/gl.h"
#include "render/mesh.h"
#include "render/programs.h"
#include "render/surface_textures.h"

namespace intaglio::render {

namespace {

Result<void> check(const RendererOptions& o) {
  if (o.supersample < 1 || o.supersample > 4) {
    return fail("renderer", fmt::format("supersample is {}", o.supersample), "it must be 1 to 4");
  }
  if (o.linear_steps < 8 || o.binary_steps < 0 || (o.shadow_steps < 4 && o.shadow_steps != 0)) {
    return fail("renderer",
                fmt::format("step counts are {} linear, {} binary, {} shadow", o.linear_steps, o.binary_steps,
                            o.shadow_steps),
                "there must be at least 8 linear and 0 binary steps, and 4 shadow steps or 0 for none");
  }
  if (!(o.roughness > 0 && o.roughness <= 1) || !(o.slab_thickness > 0)) {
    return fail("renderer",
                fmt::format("roughness is {}, slab thickness {} m", o.roughness, o.slab_thickness),
                "roughness must be over 0 and at most 1, thickness over 0");
  }
  return {};
}

// The supersampled target and the picture that it is resolved to.
struct RenderTargets {
  gl::Framebuffer samples, pixels;

  static Result<RenderTargets> create(const RendererOptions& options) {
    const int s = options.supersample;
    auto samples = gl::Framebuffer::create(options.width * s, options.height * s, GL_RGBA16F, true);
    if (!samples) return tl::unexpected(samples.error());
    auto pixels = gl::Framebuffer::create(options.width, options.height, GL_RGBA8, false);
    if (!pixels) return tl::unexpected(pixels.error());
    return RenderTargets{std::move(*samples), std::move(*pixels)};
  }
};

// The textures of the surfaces that are uploaded together: those that share their texels share them.
class SharedTextures {
 public:
  Result<std::shared_ptr<const SurfaceTextures>> of(const surface::Surface& surface) {
    auto& textures = textures_[{surface.identity(), surface.is_flat()}];
    if (!textures) {
      auto created = SurfaceTextures::create(surface);
      if (!created) return tl::unexpected(created.error());
      textures = std::make_shared<const SurfaceTextures>(std::move(*created));
    }
    return textures;
  }

 private:
  std::map<std::pair<const void*, bool>, std::shared_ptr<const SurfaceTextures>> textures_;
};

// A textured surface on the device.
struct Part {
  surface::Placement placement;
  std::shared_ptr<const SurfaceTextures> textures;
  FrameBlock block;
  std::optional<gl::VertexArray> mesh;     // replaces traced relief
  std::optional<gl::InstanceArray> shell;  // replaces the slab, on a curved base

  // Zero depth is drawn as a normal map.
  bool has_relief(const FrameScene& scene) const {
    return scene.representation == Representation::relief && block.size[2] > 0;
  }

  static Result<Part> create(const SurfacePart& part, const RendererOptions& options,
                             SharedTextures& shared) {
    auto textures = shared.of(*part.surface);
    if (!textures) return tl::unexpected(textures.error());
    const FrameBlock block = make_surface_block(part, options, (*textures)->pyramid_levels);
    Part out{part.surface->placement(), std::move(*textures), block, {}, {}};
    if (part.base) {
      const auto& place = part.surface->placement();
      // The shell must enclose the deepest texel after its height is rounded to 16 bits and the march's steps
      // are rounded; a flat one needs some thickness for its tetrahedra to be entered.
      const double depth = block.size[2] > 0 ? 1.01 * double(block.size[2]) : 1e-3 * place.size_u();
      const auto shell = shell_tetrahedra(*part.base, depth, {place.size_u(), place.size_v()});
      if (!shell) return tl::unexpected(shell.error());
      out.shell.emplace(8, std::span(shell->front().corner[0].data(), shell->size() * 24));
    } else if (part.displaced_mesh_cells > 0)
      out.mesh.emplace(slab_mesh(*part.surface, part.displaced_mesh_cells, double(block.size[3])));
    return out;
  }
};

// A solid's mesh on the device.
struct UploadedMesh {
  std::shared_ptr<const Mesh> mesh;
  gl::VertexArray triangles;
};

}  // namespace

// Everything on the device. The context is declared first so that it is destroyed last.
struct Renderer::Gpu {
  std::optional<EglContext> context;  // none: the caller's
  RendererOptions options;
  Programs programs;
  RenderTargets targets;
  std::vector<Part> parts = {};
  std::map<const Mesh*, UploadedMesh> solids = {};
  gl::UniformBuffer frame{frame_binding, sizeof(FrameBlock)};
  gl::VertexArray empty_array;
  gl::VertexArray sphere{unit_sphere()}, small_sphere{unit_sphere(24)};
  gl::VertexArray pen;
  Vec2 pen_size = Vec2::Zero();  // length and radius of the uploaded pen
  Camera camera;                 // of the last draw
  ShadowCasters casters = {};    // of the last draw

  void draw(const FrameScene& scene);
  void bind_part(Part& part, const FrameScene& scene);
  void draw_part(std::size_t index, const FrameScene& scene);
  void draw_shell(std::size_t index, const FrameScene& scene);
  void draw_balls(const std::vector<Ball>& balls);
  void draw_solids(const FrameScene& scene);
  void draw_pen(const Pen& shown);
  void resolve(const Background& background);
};

namespace {

// Makes a renderer's own context current for a scope; a caller's is current already.
std::optional<CurrentContext> make_current(const std::optional<EglContext>& context) {
  return context ? std::optional<CurrentContext>(std::in_place, *context) : std::nullopt;
}

Image8 pixels_of(const gl::Framebuffer& framebuffer) {
  Image8 image(framebuffer.width(), framebuffer.height(), 3);
  framebuffer.bind();
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE, image.data.data());
  return image;
}

}  // namespace

Result<std::unique_ptr<Renderer>> Renderer::create(const surface::Surface& surface,
                                                   const RendererOptions& options) {
  if (const auto ok = check(options); !ok) return tl::unexpected(ok.error());
  std::optional<EglContext> context;
  if (options.context == Context::own) {
    auto created = EglContext::create();
    if (!created) return tl::unexpected(created.error());
    context = std::move(*created);
  }
  const auto scope = make_current(context);
  auto targets = RenderTargets::create(options);
  if (!targets) return tl::unexpected(targets.error());
  auto programs = Programs::create(options, embedded_shaders());
  if (!programs) return tl::unexpected(programs.error());
  SharedTextures shared;
  auto part = Part::create({.surface = &surface,
                            .slab_thickness = options.slab_thickness,
                            .roughness = options.roughness,
                            .displaced_mesh_cells = options.displaced_mesh_cells},
                           options, shared);
  if (!part) return tl::unexpected(part.error());
  auto gpu = std::unique_ptr<Gpu>(new Gpu{.context = std::move(context),
                                          .options = options,
                                          .programs = std::move(*programs),
                                          .targets = std::move(*targets),
                                          .empty_array = {},
                                          .pen = {},
                                          .camera = {}});
  gpu->parts.push_back(std::move(*part));
  return std::unique_ptr<Renderer>(new Renderer(std::move(gpu)));
}

Renderer::Renderer(std::unique_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

// GL objects are destroyed with their context current.
Renderer::~Renderer() {
  const auto scope = make_current(gpu_->context);
  gpu_.reset();
}

std::string Renderer::device() const {
  const auto scope = make_current(gpu_->context);
  return description_of_current();
}

Renderer::DeviceBytes Renderer::device_bytes() const {
  DeviceBytes out;
  std::set<const SurfaceTextures*> counted;
  for (const Part& part : gpu_->parts) {
    if (counted.insert(part.textures.get()).second) out.textures += part.textures->bytes;
    if (part.mesh) out.meshes += part.mesh->bytes();
    if (part.shell) out.meshes += part.shell->bytes();
  }
  return out;
}

Result<void> Renderer::show(std::span<const SurfacePart> shown) {
  if (shown.empty()) return fail("renderer", "needs at least one surface");
  const auto scope = make_current(gpu_->context);
  std::vector<Part> parts;
  SharedTextures shared;
  for (const SurfacePart& part : shown) {
    auto created = Part::create(part, gpu_->options, shared);
    if (!created) return tl::unexpected(created.error());
    parts.push_back(std::move(*created));
  }
  gpu_->parts = std::move(parts);
  return {};
}

Result<void> Renderer::reload_shaders(const std::filesystem::path& folder) {
  const auto scope = make_current(gpu_->context);
  const auto files = shaders_from(folder);
  if (!files) return tl::unexpected(files.error());
  auto programs = Programs::create(gpu_->options, *files);
  if (!programs) return tl::unexpected(programs.error());
  gpu_->programs = std::move(*programs);
  return {};
}

Result<void> Renderer::resize(int width, int height) {
  const auto scope = make_current(gpu_->context);
  RendererOptions options = gpu_->options;
  options.width = width;
  options.height = height;
  auto targets = RenderTargets::create(options);
  if (!targets) return tl::unexpected(targets.error());
  gpu_->targets = std::move(*targets);
  gpu_->options = options;
  return {};
}

Image8 Renderer::draw(const FrameScene& scene) {
  const auto scope = make_current(gpu_->context);
  gpu_->draw(scene);
  return pixels_of(gpu_->targets.pixels);
}

void Renderer::draw_to(const FrameScene& scene, unsigned framebuffer, int width, int height) {
  const auto scope = make_current(gpu_->context);
  gpu_->draw(scene);
  const gl::Framebuffer& pixels = gpu_->targets.pixels;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, pixels.name());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  // Pictures have their top row first, windows their bottom row.
  glBlitFramebuffer(0, 0, pixels.width(), pixels.height(), 0, height, width, 0, GL_COLOR_BUFFER_BIT,
                    pixels.width() == width && pixels.height() == height ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, width, height);
  glDisable(GL_CULL_FACE);
}

Result<Image8> Renderer::capture(int width, int height) {
  const auto scope = make_current(gpu_->context);
  auto target = gl::Framebuffer::create(width, height, GL_RGBA8, false);
  if (!target) return tl::unexpected(target.error());
  const gl::Framebuffer& pixels = gpu_->targets.pixels;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, pixels.name());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target->name());
  glBlitFramebuffer(0, 0, pixels.width(), pixels.height(), 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                    GL_LINEAR);
  return pixels_of(*target);
}

void Renderer::Gpu::draw(const FrameScene& scene) {
  camera = scene.camera;
  casters = shadow_casters(scene);
  targets.samples.bind();
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  glCullFace(GL_BACK);
  bind_part(parts.front(), scene);
  draw_balls(scene.balls);
  draw_solids(scene);
  if (scene.pen) draw_pen(*scene.pen);
  draw_part(0, scene);
  for (std::size_t k = 1; k < parts.size(); ++k) {
    bind_part(parts[k], scene);
    draw_part(k, scene);
  }
  resolve(scene.background);
}

// Draws that follow are in the part's frame and read its textures.
void Renderer::Gpu::bind_part(Part& part, const FrameScene& scene) {
  update_frame_block(part.block, scene, casters, part.placement, options);
  frame.write(&part.block);
  part.textures->heights.bind(heights_unit);
  part.textures->bounds.bind(bounds_unit);
  part.textures->normals.bind(normals_unit);
  part.textures->colour.bind(colour_unit);
}

void Renderer::Gpu::draw_part(std::size_t index, const FrameScene& scene) {
  Part& part = parts[index];
  if (part.shell) return draw_shell(index, scene);
  if (part.mesh && scene.representation == Representation::relief) {
    const gl::Instance here;
    programs.mesh.use();
    part.mesh->draw({&here, 1});
    return;
  }
  (part.has_relief(scene) ? programs.relief_slab : programs.slab).use();
  glCullFace(GL_FRONT);
  empty_array.draw_unindexed(36);
  glCullFace(GL_BACK);
}

void Renderer::Gpu::draw_shell(std::size_t index, const FrameScene& scene) {
  const Pose pose = index < scene.part_poses.size() ? scene.part_poses[index].pose : Pose();
  const gl::Program& shell = parts[index].has_relief(scene) ? programs.relief_shell : programs.shell;
  shell.use();
  shell.set("model", model_matrix(pose, 1, parts[index].placement));
  shell.set("self_caster", index < casters.parts.size() ? casters.parts[index] : -1);
  glCullFace(GL_FRONT);
  parts[index].shell->draw();
  glCullFace(GL_BACK);
}

void Renderer::Gpu::draw_balls(const std::vector<Ball>& balls) {
  // The silhouette of the small sphere is 1 - cos(pi / 24) of its radius off: 1/20 of a sample here. Only a
  // crowd has so many triangles that they cost anything.
  constexpr double small_radius = 6;  // samples
  constexpr std::size_t crowd = 64;
  const double samples_a_radian =
      0.5 * options.height * options.supersample / std::tan(camera.fov_y_degrees * std::numbers::pi / 360);
  std::vector<gl::Instance> near, far;
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const Ball& ball = balls[k];
    const double distance = (ball.pose.position - camera.eye).norm() - ball.radius;
    const bool small = balls.size() > crowd && ball.radius * samples_a_radian < small_radius * distance;
    (small ? far : near)
        .push_back({model_matrix(ball.pose, ball.radius, parts.front().placement), ball.colour.cast<float>(),
                    ball.second_colour.cast<float>(), casters.balls[k]});
  }
  programs.ball.use();
  sphere.draw(near);
  small_sphere.draw(far);
}

void Renderer::Gpu::draw_solids(const FrameScene& scene) {
  std::map<const Mesh*, std::vector<gl::Instance>> instances;
  std::vector<const Mesh*> order;  // as in the scene, so that pictures do not depend on addresses
  for (std::size_t k = 0; k < scene.solids.size(); ++k) {
    const Solid& solid = scene.solids[k];
    auto& bodies = instances[solid.mesh.get()];
    if (bodies.empty()) order.push_back(solid.mesh.get());
    bodies.push_back({model_matrix(solid.pose, 1, parts.front().placement), solid.colour.cast<float>(),
                      Eigen::Vector3f::Zero(), casters.solids[k]});
    if (!solids.contains(solid.mesh.get()))
      solids.emplace(solid.mesh.get(), UploadedMesh{solid.mesh, gl::VertexArray(*solid.mesh)});
  }
  std::erase_if(solids, [&](const auto& entry) { return !instances.contains(entry.first); });
  programs.plain.use();
  for (const Mesh* mesh : order) solids.at(mesh).triangles.draw(instances[mesh]);
}

void Renderer::Gpu::draw_pen(const Pen& shown) {
  if (const Vec2 size(shown.length, shown.radius); size != pen_size) {
    pen = gl::VertexArray(pen_mesh(shown.length, shown.radius));
    pen_size = size;
  }
  const gl::Instance here{model_matrix(pen_pose(shown), 1, parts.front().placement),
                          shown.colour.cast<float>()};
  programs.pen.use();
  pen.draw({&here, 1});
}

void Renderer::Gpu::resolve(const Background& background) {
  targets.pixels.bind();
  glDisable(GL_DEPTH_TEST);
  targets.samples.colour().bind(samples_unit);
  programs.resolve.use();
  programs.resolve.set("background_top", Eigen::Vector3f(background.top.cast<float>()));
  programs.resolve.set("background_bottom", Eigen::Vector3f(background.bottom.cast<float>()));
  empty_array.draw_unindexed(3);
}

// Window depth w maps the distance z from `near` to `far` by w = far (z - near) / (z (far - near)), so
// z = near far / (far - w (far - near)).
std::vector<float> Renderer::depth() const {
  const Gpu& gpu = *gpu_;
  const auto scope = make_current(gpu.context);
  gpu.targets.samples.bind();
  const auto s = std::size_t(gpu.options.supersample);
  const auto width = std::size_t(gpu.options.width);
  const auto height = std::size_t(gpu.options.height);
  std::vector<float> window(width * s * height * s);
  glReadPixels(0, 0, gpu.targets.samples.width(), gpu.targets.samples.height(), GL_DEPTH_COMPONENT, GL_FLOAT,
               window.data());
  const double near = gpu.camera.near;
  const double far = gpu.camera.far;
  std::vector<float> out(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const double w = window[((height - 1 - y) * s + s / 2) * width * s + x * s + s / 2];
      out[y * width + x] =
          w < 1 ? float(near * far / (far - w * (far - near))) : std::numeric_limits<float>::infinity();
    }
  }
  return out;
}

}  // namespace intaglio::render
