#include "render/renderer.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <fmt/format.h>

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

// What pictures are drawn into: samples, and the pixels that they become.
struct Canvas {
  gl::Framebuffer samples, pixels;

  static Result<Canvas> create(const RendererOptions& options) {
    const int s = options.supersample;
    auto samples = gl::Framebuffer::create(options.width * s, options.height * s, GL_RGBA16F, true);
    if (!samples) return tl::unexpected(samples.error());
    auto pixels = gl::Framebuffer::create(options.width, options.height, GL_RGBA8, false);
    if (!pixels) return tl::unexpected(pixels.error());
    return Canvas{std::move(*samples), std::move(*pixels)};
  }
};

// A textured rectangle on the device.
struct Part {
  surface::Placement placement;
  SurfaceTextures textures;
  FrameBlock block;
  std::optional<gl::VertexArray> mesh;     // in place of traced relief
  std::optional<gl::InstanceArray> shell;  // of a curved base, in place of a slab

  // A relief without depth is the plane, and its normals are drawn.
  bool has_relief(const FrameScene& scene) const {
    return scene.representation == Representation::relief && block.size[2] > 0;
  }

  static Result<Part> create(const SurfacePart& part, const RendererOptions& options) {
    auto textures = SurfaceTextures::create(*part.surface);
    if (!textures) return tl::unexpected(textures.error());
    const FrameBlock block = surface_block(part, options, textures->pyramid_levels);
    Part out{part.surface->placement(), std::move(*textures), block, {}, {}};
    if (part.base) {
      const auto& place = part.surface->placement();
      const double depth = block.size[2] > 0 ? 1.01 * double(block.size[2]) : 1e-3 * place.size_u();
      const auto shell = make_shell(*part.base, depth, {place.size_u(), place.size_v()});
      if (!shell) return tl::unexpected(shell.error());
      out.shell.emplace(8, std::span(shell->front().corner[0].data(), shell->size() * 24));
    } else if (part.mesh_cells > 0)
      out.mesh.emplace(slab_mesh(*part.surface, part.mesh_cells, double(block.size[3])));
    return out;
  }
};

// A solid's mesh on the device, and whether the last picture had it.
struct Uploaded {
  std::shared_ptr<const Mesh> mesh;
  gl::VertexArray triangles;
  bool is_used = true;
};

}  // namespace

// Everything that lives on the device. The context is first: it dies last.
struct Renderer::Gpu {
  std::optional<EglContext> context;  // none: the caller's
  RendererOptions options;
  Programs programs;
  Canvas canvas;
  std::vector<Part> parts = {};
  std::map<const Mesh*, Uploaded> solids = {};
  gl::UniformBuffer frame{frame_binding, sizeof(FrameBlock)};
  gl::VertexArray no_vertices;
  gl::VertexArray sphere{unit_sphere()};
  gl::VertexArray pen_mesh;
  Vec2 pen_mesh_size = Vec2::Zero();  // length and radius that pen_mesh was made for
  Camera camera;                      // of the last draw

  void draw(const FrameScene& scene);
  void begin(Part& part, const FrameScene& scene);
  void draw_part(std::size_t index, const FrameScene& scene);
  void draw_shell(std::size_t index, const FrameScene& scene);
  void draw_balls(const std::vector<Ball>& balls);
  void draw_solids(const FrameScene& scene);
  void draw_pen(const Pen& pen_);
  void resolve(const Background& background);
};

namespace {

// The context of its own is current for as long as this lives; a caller's is already.
std::optional<Current> current(const std::optional<EglContext>& context) {
  return context ? std::optional<Current>(std::in_place, *context) : std::nullopt;
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
  auto canvas = Canvas::create(options);
  if (!canvas) return tl::unexpected(canvas.error());
  auto programs = Programs::create(options, embedded_shaders());
  if (!programs) return tl::unexpected(programs.error());
  auto part = Part::create({.surface = &surface,
                            .slab_thickness = options.slab_thickness,
                            .roughness = options.roughness,
                            .mesh_cells = options.mesh_cells},
                           options);
  if (!part) return tl::unexpected(part.error());
  auto gpu = std::unique_ptr<Gpu>(new Gpu{.context = std::move(context),
                                          .options = options,
                                          .programs = std::move(*programs),
                                          .canvas = std::move(*canvas),
                                          .no_vertices = {},
                                          .pen_mesh = {},
                                          .camera = {}});
  gpu->parts.push_back(std::move(*part));
  if (gpu->context) gpu->context->release();
  return std::unique_ptr<Renderer>(new Renderer(std::move(gpu)));
}

Renderer::Renderer(std::unique_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

// The device's objects die with their context current; it lets go when it dies, last.
Renderer::~Renderer() {
  if (gpu_->context) gpu_->context->make_current();
}

std::string Renderer::device() const {
  const auto scope = current(gpu_->context);
  return description_of_current();
}

Renderer::DeviceBytes Renderer::device_bytes() const {
  DeviceBytes out;
  for (const Part& part : gpu_->parts) {
    out.textures += part.textures.bytes;
    if (part.mesh) out.meshes += part.mesh->bytes();
    if (part.shell) out.meshes += part.shell->bytes();
  }
  return out;
}

Result<void> Renderer::show(std::span<const SurfacePart> shown) {
  if (shown.empty()) return fail("renderer", "was given no surface to show", "give at least one");
  const auto scope = current(gpu_->context);
  std::vector<Part> parts;
  for (const SurfacePart& part : shown) {
    auto created = Part::create(part, gpu_->options);
    if (!created) return tl::unexpected(created.error());
    parts.push_back(std::move(*created));
  }
  gpu_->parts = std::move(parts);
  return {};
}

Result<void> Renderer::reload_shaders(const std::filesystem::path& folder) {
  const auto scope = current(gpu_->context);
  const auto files = shaders_from(folder);
  if (!files) return tl::unexpected(files.error());
  auto programs = Programs::create(gpu_->options, *files);
  if (!programs) return tl::unexpected(programs.error());
  gpu_->programs = std::move(*programs);
  return {};
}

Result<void> Renderer::resize(int width, int height) {
  const auto scope = current(gpu_->context);
  RendererOptions options = gpu_->options;
  options.width = width;
  options.height = height;
  auto canvas = Canvas::create(options);
  if (!canvas) return tl::unexpected(canvas.error());
  gpu_->canvas = std::move(*canvas);
  gpu_->options = options;
  return {};
}

Image8 Renderer::draw(const FrameScene& scene) {
  const auto scope = current(gpu_->context);
  gpu_->draw(scene);
  return pixels_of(gpu_->canvas.pixels);
}

void Renderer::draw_to(const FrameScene& scene, unsigned framebuffer, int width, int height) {
  const auto scope = current(gpu_->context);
  gpu_->draw(scene);
  const gl::Framebuffer& pixels = gpu_->canvas.pixels;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, pixels.name());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  // Pixels have their top row first, a window its bottom row.
  glBlitFramebuffer(0, 0, pixels.width(), pixels.height(), 0, height, width, 0, GL_COLOR_BUFFER_BIT,
                    pixels.width() == width && pixels.height() == height ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, width, height);
  glDisable(GL_CULL_FACE);
}

Result<Image8> Renderer::capture(int width, int height) {
  const auto scope = current(gpu_->context);
  auto target = gl::Framebuffer::create(width, height, GL_RGBA8, false);
  if (!target) return tl::unexpected(target.error());
  const gl::Framebuffer& pixels = gpu_->canvas.pixels;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, pixels.name());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target->name());
  glBlitFramebuffer(0, 0, pixels.width(), pixels.height(), 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                    GL_LINEAR);
  return pixels_of(*target);
}

void Renderer::Gpu::draw(const FrameScene& scene) {
  camera = scene.camera;
  canvas.samples.bind();
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  glCullFace(GL_BACK);
  begin(parts.front(), scene);
  draw_balls(scene.balls);
  draw_solids(scene);
  if (scene.pen) draw_pen(*scene.pen);
  draw_part(0, scene);
  for (std::size_t k = 1; k < parts.size(); ++k) {
    begin(parts[k], scene);
    draw_part(k, scene);
  }
  resolve(scene.background);
}

// What is drawn next is drawn in that part's frame.
void Renderer::Gpu::begin(Part& part, const FrameScene& scene) {
  fill_frame(part.block, scene, part.placement, options);
  frame.write(&part.block);
  part.textures.heights.bind(heights_unit);
  part.textures.bounds.bind(bounds_unit);
  part.textures.normals.bind(normals_unit);
  part.textures.colour.bind(colour_unit);
}

void Renderer::Gpu::draw_part(std::size_t index, const FrameScene& scene) {
  const Part& part = parts[index];
  if (part.shell) return draw_shell(index, scene);
  if (part.mesh && scene.representation == Representation::relief) {
    programs.mesh.use();
    programs.mesh.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    part.mesh->draw();
    return;
  }
  (part.has_relief(scene) ? programs.relief_slab : programs.slab).use();
  glCullFace(GL_FRONT);
  no_vertices.draw_unindexed(36);
  glCullFace(GL_BACK);
}

void Renderer::Gpu::draw_shell(std::size_t index, const FrameScene& scene) {
  const Pose pose = index < scene.part_poses.size() ? scene.part_poses[index].pose : Pose();
  const gl::Program& shell = parts[index].has_relief(scene) ? programs.relief_shell : programs.shell;
  shell.use();
  shell.set("model", model_matrix(pose, 1, parts[index].placement));
  shell.set("self_caster", caster_of_part(scene, index));
  glCullFace(GL_FRONT);
  parts[index].shell->draw();
  glCullFace(GL_BACK);
}

void Renderer::Gpu::draw_balls(const std::vector<Ball>& balls) {
  programs.ball.use();
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const Ball& ball = balls[k];
    programs.ball.set("model", model_matrix(ball.pose, ball.radius, parts.front().placement));
    programs.ball.set("self", k < max_shadow_balls ? static_cast<int>(k) : -2);
    programs.ball.set("colour_a", Eigen::Vector3f(ball.colour.cast<float>()));
    programs.ball.set("colour_b", Eigen::Vector3f(ball.second_colour.cast<float>()));
    sphere.draw();
  }
}

void Renderer::Gpu::draw_solids(const FrameScene& scene) {
  programs.plain.use();
  for (auto& entry : solids) entry.second.is_used = false;
  int caster = static_cast<int>(scene.balls.size());
  for (const Solid& solid : scene.solids) {
    auto [at, is_new] = solids.try_emplace(solid.mesh.get());
    if (is_new) at->second = {solid.mesh, gl::VertexArray(*solid.mesh)};
    at->second.is_used = true;
    programs.plain.set("model", model_matrix(solid.pose, 1, parts.front().placement));
    const bool casts = solid.shadow_radius > 0 && caster < max_shadow_balls;
    programs.plain.set("self", casts ? caster : -2);
    if (solid.shadow_radius > 0) ++caster;
    programs.plain.set("colour_a", Eigen::Vector3f(solid.colour.cast<float>()));
    at->second.triangles.draw();
  }
  std::erase_if(solids, [](const auto& entry) { return !entry.second.is_used; });
}

void Renderer::Gpu::draw_pen(const Pen& pen_) {
  if (const Vec2 wanted(pen_.length, pen_.radius); wanted != pen_mesh_size) {
    pen_mesh = gl::VertexArray(pen(pen_.length, pen_.radius));
    pen_mesh_size = wanted;
  }
  programs.pen.use();
  programs.pen.set("model", model_matrix(pen_pose(pen_), 1, parts.front().placement));
  programs.pen.set("colour_a", Eigen::Vector3f(pen_.colour.cast<float>()));
  pen_mesh.draw();
}

void Renderer::Gpu::resolve(const Background& background) {
  canvas.pixels.bind();
  glDisable(GL_DEPTH_TEST);
  canvas.samples.colour().bind(samples_unit);
  programs.resolve.use();
  programs.resolve.set("background_top", Eigen::Vector3f(background.top.cast<float>()));
  programs.resolve.set("background_bottom", Eigen::Vector3f(background.bottom.cast<float>()));
  no_vertices.draw_unindexed(3);
}

std::vector<float> Renderer::depth() const {
  const Gpu& gpu = *gpu_;
  const auto scope = current(gpu.context);
  gpu.canvas.samples.bind();
  const auto s = static_cast<std::size_t>(gpu.options.supersample);
  const auto width = static_cast<std::size_t>(gpu.options.width);
  const auto height = static_cast<std::size_t>(gpu.options.height);
  std::vector<float> window(width * s * height * s);
  glReadPixels(0, 0, gpu.canvas.samples.width(), gpu.canvas.samples.height(), GL_DEPTH_COMPONENT, GL_FLOAT,
               window.data());
  const double near = gpu.camera.near;
  const double far = gpu.camera.far;
  std::vector<float> out(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const double w = window[((height - 1 - y) * s + s / 2) * width * s + x * s + s / 2];
      out[y * width + x] = w < 1 ? static_cast<float>(near * far / (far - w * (far - near)))
                                 : std::numeric_limits<float>::infinity();
    }
  }
  return out;
}

}  // namespace intaglio::render
