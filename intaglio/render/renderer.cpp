#include "intaglio/render/renderer.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "intaglio/render/egl_context.h"
#include "intaglio/render/frame_block.h"
#include "intaglio/render/gl.h"
#include "intaglio/render/mesh.h"
#include "intaglio/render/surface_textures.h"
#include "intaglio_shaders.h"

namespace intaglio::render {

namespace {

constexpr GLuint frame_binding = 0;
enum Unit { heights_unit, bounds_unit, relief_unit, colour_unit, samples_unit };

struct Programs {
  gl::Program slab, ball, pen, resolve;

  static Result<Programs> create(March march);
};

// Tells a program where the frame's block and the textures are; those it does not use are ignored.
void connect(const gl::Program& program) {
  program.bind_block("Frame", frame_binding);
  program.use();
  program.set("heights", heights_unit);
  program.set("bounds", bounds_unit);
  program.set("relief", relief_unit);
  program.set("colour", colour_unit);
  program.set("samples", samples_unit);
}

Result<Programs> Programs::create(March march) {
  using namespace shaders;
  const char* search = march == March::classic ? march_classic_glsl : march_pyramid_glsl;
  auto slab = gl::Program::create("slab", {frame_glsl, slab_vert},
                                  {frame_glsl, heights_glsl, search, shadow_glsl, lighting_glsl, slab_frag});
  if (!slab) return tl::unexpected(slab.error());
  auto ball = gl::Program::create("ball", {frame_glsl, solid_vert},
                                  {frame_glsl, heights_glsl, shadow_glsl, lighting_glsl, ball_frag});
  if (!ball) return tl::unexpected(ball.error());
  auto pen = gl::Program::create("pen", {frame_glsl, solid_vert},
                                 {frame_glsl, heights_glsl, shadow_glsl, lighting_glsl, pen_frag});
  if (!pen) return tl::unexpected(pen.error());
  auto resolve = gl::Program::create("resolve", {screen_vert}, {resolve_frag});
  if (!resolve) return tl::unexpected(resolve.error());
  Programs result{std::move(*slab), std::move(*ball), std::move(*pen), std::move(*resolve)};
  for (const gl::Program* program : {&result.slab, &result.ball, &result.pen, &result.resolve})
    connect(*program);
  return result;
}

Result<void> check(const RendererOptions& o) {
  if (o.supersample < 1 || o.supersample > 4) {
    return fail("renderer", fmt::format("supersample is {}", o.supersample), "it must be 1 to 4");
  }
  if (o.linear_steps < 8 || o.binary_steps < 0 || o.shadow_steps < 4) {
    return fail("renderer",
                fmt::format("step counts are {} linear, {} binary, {} shadow", o.linear_steps, o.binary_steps,
                            o.shadow_steps),
                "there must be at least 8 linear, 0 binary and 4 shadow steps");
  }
  if (!(o.roughness > 0 && o.roughness <= 1) || !(o.slab_thickness > 0)) {
    return fail("renderer",
                fmt::format("roughness is {}, slab thickness {} m", o.roughness, o.slab_thickness),
                "roughness must be over 0 and at most 1, thickness over 0");
  }
  return {};
}

}  // namespace

// Everything that lives on the device. The context is first: it dies last.
struct Renderer::Gpu {
  EglContext context;
  surface::Placement placement;
  RendererOptions options;
  SurfaceTextures textures;
  Programs programs;
  gl::Framebuffer samples;
  gl::Framebuffer pixels;
  FrameBlock block;
  gl::UniformBuffer frame{frame_binding, sizeof(FrameBlock)};
  gl::VertexArray no_vertices;
  gl::VertexArray sphere{unit_sphere()};
  gl::VertexArray pen_mesh;
  Vec2 pen_mesh_size = Vec2::Zero();  // length and radius that pen_mesh was made for
  Camera camera;                      // of the last draw

  void draw_slab();
  void draw_balls(const std::vector<Ball>& balls);
  void draw_pen(const Pen& pen_);
  Image8 resolve(const Background& background);
};

Result<std::unique_ptr<Renderer>> Renderer::create(const surface::Surface& surface,
                                                   const RendererOptions& options) {
  if (const auto ok = check(options); !ok) return tl::unexpected(ok.error());
  auto context = EglContext::create();
  if (!context) return tl::unexpected(context.error());
  const int s = options.supersample;
  auto samples = gl::Framebuffer::create(options.width * s, options.height * s, GL_RGBA16F, true);
  if (!samples) return tl::unexpected(samples.error());
  auto pixels = gl::Framebuffer::create(options.width, options.height, GL_RGBA8, false);
  if (!pixels) return tl::unexpected(pixels.error());
  auto programs = Programs::create(options.march);
  if (!programs) return tl::unexpected(programs.error());
  auto textures = SurfaceTextures::create(surface);
  if (!textures) return tl::unexpected(textures.error());
  const FrameBlock block = surface_block(surface, options, textures->pyramid_levels);
  auto gpu = std::unique_ptr<Gpu>(new Gpu{.context = std::move(*context),
                                          .placement = surface.placement(),
                                          .options = options,
                                          .textures = std::move(*textures),
                                          .programs = std::move(*programs),
                                          .samples = std::move(*samples),
                                          .pixels = std::move(*pixels),
                                          .block = block,
                                          .no_vertices = {},
                                          .pen_mesh = {},
                                          .camera = {}});
  gpu->context.release();
  return std::unique_ptr<Renderer>(new Renderer(std::move(gpu)));
}

Renderer::Renderer(std::unique_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

// The device's objects die with their context current; it lets go when it dies, last.
Renderer::~Renderer() {
  gpu_->context.make_current();
}

std::string Renderer::device() const {
  const Current current(gpu_->context);
  return gpu_->context.description();
}

Image8 Renderer::draw(const FrameScene& scene) {
  Gpu& gpu = *gpu_;
  const Current current(gpu.context);
  gpu.camera = scene.camera;
  fill_frame(gpu.block, scene, gpu.placement, gpu.options);
  gpu.frame.write(&gpu.block);
  gpu.samples.bind();
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  gpu.textures.heights.bind(heights_unit);
  gpu.textures.bounds.bind(bounds_unit);
  gpu.textures.relief.bind(relief_unit);
  gpu.textures.colour.bind(colour_unit);
  gpu.draw_balls(scene.balls);
  if (scene.pen) gpu.draw_pen(*scene.pen);
  gpu.draw_slab();
  return gpu.resolve(scene.background);
}

void Renderer::Gpu::draw_slab() {
  programs.slab.use();
  glCullFace(GL_FRONT);
  no_vertices.draw_unindexed(36);
  glCullFace(GL_BACK);
}

void Renderer::Gpu::draw_balls(const std::vector<Ball>& balls) {
  programs.ball.use();
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const Ball& ball = balls[k];
    programs.ball.set("model", model_matrix(ball.pose, ball.radius, placement));
    programs.ball.set("self", k < max_shadow_balls ? static_cast<int>(k) : -2);
    programs.ball.set("colour_a", Eigen::Vector3f(ball.colour.cast<float>()));
    programs.ball.set("colour_b", Eigen::Vector3f(ball.second_colour.cast<float>()));
    sphere.draw();
  }
}

void Renderer::Gpu::draw_pen(const Pen& pen_) {
  if (const Vec2 wanted(pen_.length, pen_.radius); wanted != pen_mesh_size) {
    pen_mesh = gl::VertexArray(pen(pen_.length, pen_.radius));
    pen_mesh_size = wanted;
  }
  programs.pen.use();
  programs.pen.set("model", model_matrix(pen_pose(pen_), 1, placement));
  programs.pen.set("colour_a", Eigen::Vector3f(pen_.colour.cast<float>()));
  pen_mesh.draw();
}

Image8 Renderer::Gpu::resolve(const Background& background) {
  pixels.bind();
  glDisable(GL_DEPTH_TEST);
  samples.colour().bind(samples_unit);
  programs.resolve.use();
  programs.resolve.set("supersample", options.supersample);
  programs.resolve.set("background_top", Eigen::Vector3f(background.top.cast<float>()));
  programs.resolve.set("background_bottom", Eigen::Vector3f(background.bottom.cast<float>()));
  no_vertices.draw_unindexed(3);
  Image8 image(options.width, options.height, 3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE, image.data.data());
  return image;
}

std::vector<float> Renderer::depth() const {
  const Gpu& gpu = *gpu_;
  const Current current(gpu.context);
  gpu.samples.bind();
  const auto s = static_cast<std::size_t>(gpu.options.supersample);
  const auto width = static_cast<std::size_t>(gpu.options.width);
  const auto height = static_cast<std::size_t>(gpu.options.height);
  std::vector<float> window(width * s * height * s);
  glReadPixels(0, 0, gpu.samples.width(), gpu.samples.height(), GL_DEPTH_COMPONENT, GL_FLOAT, window.data());
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
