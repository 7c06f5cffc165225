#include "render/programs.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/file.h"
#include "intaglio/vec.h"
#include "intaglio_shaders.h"
#include "render/mesh.h"
#include "render/surface_textures.h"

namespace intaglio::render {

ShaderFiles embedded_shaders() {
  ShaderFiles out;
  for (const auto& [name, text] : embedded_shader_files) out[name] = text;
  return out;
}

Result<ShaderFiles> shaders_from(const std::filesystem::path& folder) {
  ShaderFiles out = embedded_shaders();
  int found = 0;
  for (auto& [name, text] : out) {
    std::error_code missing;
    if (!std::filesystem::is_regular_file(folder / name, missing)) continue;
    const auto bytes = read_file(folder / name, 1u << 20);  // Trusted: shaders that the user edits
    if (!bytes) return tl::unexpected(bytes.error());
    text.assign(bytes->begin(), bytes->end());
    ++found;
  }
  if (found == 0)
    return fail(folder.string(), "contains no shader files",
                "name them as the built-in ones, such as slab.frag");
  return out;
}

CameraBasis basis_of(const Camera& camera) {
  const Vec3 back = (camera.eye - camera.target).normalized();
  const bool up_is_parallel = camera.up.cross(back).norm() < 1e-9 * camera.up.norm();
  const Vec3 up = up_is_parallel ? -Vec3::UnitZ() : camera.up;
  const Vec3 right = up.cross(back).normalized();
  return {right, back.cross(right), back};
}

ShadowCasters shadow_casters(const FrameScene& scene) {
  ShadowCasters out;
  const auto add = [&](const Pose& pose, double radius) {
    if (!(radius > 0) || out.spheres.size() == max_shadow_balls) return -1;
    out.spheres.push_back({pose.position, radius});
    return int(out.spheres.size()) - 1;
  };
  for (const Ball& ball : scene.balls) out.balls.push_back(add(ball.pose, ball.radius));
  for (const Solid& solid : scene.solids) out.solids.push_back(add(solid.pose, solid.shadow_radius));
  for (const auto& part : scene.part_poses) out.parts.push_back(add(part.pose, part.shadow_radius));
  return out;
}

namespace {

constexpr double degree = std::numbers::pi / 180;

FrameBlock::Vec4 vec4(const Vec3& v, double w = 0) {
  return {float(v.x()), float(v.y()), float(v.z()), float(w)};
}

// World to camera: x right, y up, looking along -z.
Eigen::Matrix4d look_at(const Camera& camera) {
  const CameraBasis basis = basis_of(camera);
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.block<1, 3>(0, 0) = basis.right.transpose();
  view.block<1, 3>(1, 0) = basis.up.transpose();
  view.block<1, 3>(2, 0) = basis.back.transpose();
  view.block<3, 1>(0, 3) = -(view.block<3, 3>(0, 0) * camera.eye);
  return view;
}

Eigen::Matrix4d perspective(const Camera& camera, double aspect) {
  const double f = 1 / std::tan(0.5 * camera.fov_y_degrees * degree);
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = f / aspect;
  m(1, 1) = f;
  m(2, 2) = (camera.far + camera.near) / (camera.near - camera.far);
  m(2, 3) = 2 * camera.far * camera.near / (camera.near - camera.far);
  m(3, 2) = -1;
  return m;
}

Eigen::Matrix4d local_to_world(const surface::Placement& placement) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<3, 1>(0, 0) = placement.t();
  m.block<3, 1>(0, 1) = placement.b();
  m.block<3, 1>(0, 2) = placement.n();
  m.block<3, 1>(0, 3) = placement.to_world(Vec3::Zero());
  return m;
}

void fill_light(FrameBlock& block, const Light& light, const surface::Placement& placement) {
  block.light = light.position ? vec4(placement.to_local(*light.position), 1)
                               : vec4(placement.direction_to_local(light.direction.normalized()), 0);
  block.light_colour = vec4(light.colour, std::tan(light.radius_degrees * degree));
  block.sky = vec4(light.sky);
  block.ground = vec4(light.ground);
}

void fill_bodies(FrameBlock& block, const FrameScene& scene, const ShadowCasters& casters,
                 const surface::Placement& placement) {
  std::transform(casters.spheres.begin(), casters.spheres.end(), block.ball.begin(),
                 [&](const auto& sphere) { return vec4(placement.to_local(sphere.centre), sphere.radius); });
  block.count = {std::int32_t(casters.spheres.size()), scene.pen ? 1 : 0, std::int32_t(scene.representation),
                 block.count[3]};
  if (!scene.pen) return;
  const Pen& pen = *scene.pen;
  block.pen_tip = vec4(placement.to_local(pen.tip), pen.radius);
  block.pen_direction = vec4(placement.direction_to_local(pen.direction.normalized()), pen.length);
  block.pen_cone = vec4(Vec3(std::min(pen_tip_radii * pen.radius, pen.length), 0, 0));
}

}  // namespace

FrameBlock make_surface_block(const SurfacePart& part, const RendererOptions& options, int pyramid_levels) {
  FrameBlock block = {};
  const surface::Surface& surface = *part.surface;
  const auto& placement = surface.placement();
  const double depth = surface.has_depth() ? surface.max_depth() : 0;
  // A floor remains under the deepest groove.
  const double slab = std::max(part.slab_thickness, 1.25 * depth);
  block.size = vec4({placement.size_u(), placement.size_v(), depth}, slab);
  block.texels = vec4(
      {double(surface.width()), double(surface.height()), std::min(surface.texel_u(), surface.texel_v())},
      surface.colour().empty() ? 0 : 1);
  block.material = vec4(options.colour, part.roughness);
  block.steps = {options.linear_steps, options.binary_steps, options.shadow_steps, pyramid_levels};
  if (options.detail == Detail::by_footprint)
    block.count[3] = std::clamp(pyramid_levels - 1, 0, HeightLevels::coarsest_traced);
  return block;
}

void update_frame_block(FrameBlock& block, const FrameScene& scene, const ShadowCasters& casters,
                        const surface::Placement& placement, const RendererOptions& options) {
  const Camera& camera = scene.camera;
  const Eigen::Matrix4f view_projection = (perspective(camera, double(options.width) / options.height) *
                                           look_at(camera) * local_to_world(placement))
                                              .cast<float>();
  std::copy_n(view_projection.data(), 16, block.view_projection.begin());
  const double sample_angle =
      2 * std::tan(0.5 * camera.fov_y_degrees * degree) / (options.height * options.supersample);
  block.eye = vec4(placement.to_local(camera.eye), sample_angle);
  fill_light(block, scene.light, placement);
  fill_bodies(block, scene, casters, placement);
}

Eigen::Matrix4f model_matrix(const Pose& pose, double scale, const surface::Placement& placement) {
  Mat3 world_to_local;
  world_to_local << placement.t().transpose(), placement.b().transpose(), placement.n().transpose();
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<3, 3>(0, 0) = world_to_local * pose.orientation.toRotationMatrix() * scale;
  m.block<3, 1>(0, 3) = placement.to_local(pose.position);
  return m.cast<float>();
}

Pose pen_pose(const Pen& pen) {
  return {pen.tip, rotation_onto(Vec3::UnitZ(), pen.direction)};
}

namespace {

// Unused samplers have location -1, which GL ignores.
void bind_samplers(const gl::Program& program) {
  program.bind_block("Frame", frame_binding);
  program.use();
  program.set("heights", heights_unit);
  program.set("bounds", bounds_unit);
  program.set("normals", normals_unit);
  program.set("colour", colour_unit);
  program.set("samples", samples_unit);
  program.set("self_caster", -1);
}

}  // namespace

Result<Programs> Programs::create(const RendererOptions& options, const ShaderFiles& files) {
  using Names = std::vector<std::string>;
  const std::string search = options.march == March::classic ? "march_classic.glsl" : "march_pyramid.glsl";
  // `constant` defines RELIEF: whether the surface is drawn as relief.
  const auto link = [&](gl::Program& program, const char* name, const std::string& constant,
                        const Names& vertex, const Names& fragment) -> Result<void> {
    const auto sources = [&](const Names& names) {
      gl::Program::Sources out{{"(constants)", constant + "\n"}};
      for (const std::string& file : names) out.push_back({file, files.at(file)});
      return out;
    };
    auto created = gl::Program::create(name, sources(vertex), sources(fragment));
    if (!created) return tl::unexpected(created.error());
    program = std::move(*created);
    bind_samplers(program);
    return {};
  };
  const auto link_surface = [&](gl::Program& program, const char* name, const char* vertex, bool relief) {
    return link(program, name, fmt::format("const bool RELIEF = {};", relief), {"frame.glsl", vertex},
                {"frame.glsl", "heights.glsl", search, "shadow.glsl", "lighting.glsl", "surface_shading.glsl",
                 fmt::format("{}.frag", name)});
  };
  const auto link_solid = [&](gl::Program& program, const char* name) {
    return link(program, name, "#define RELIEF (count.z == 2)", {"frame.glsl", "solid.vert"},
                {"frame.glsl", "heights.glsl", "shadow.glsl", "lighting.glsl", fmt::format("{}.frag", name)});
  };
  Programs result;
  Result<void> ok = link_surface(result.relief_slab, "slab", "slab.vert", true);
  if (ok) ok = link_surface(result.slab, "slab", "slab.vert", false);
  if (ok) ok = link_surface(result.mesh, "mesh", "solid.vert", true);
  if (ok) ok = link_surface(result.relief_shell, "shell", "shell.vert", true);
  if (ok) ok = link_surface(result.shell, "shell", "shell.vert", false);
  if (ok) ok = link_solid(result.ball, "ball");
  if (ok) ok = link_solid(result.plain, "plain");
  if (ok) ok = link_solid(result.pen, "pen");
  if (ok)
    ok = link(result.resolve, "resolve", fmt::format("const int SUPERSAMPLE = {};", options.supersample),
              {"screen.vert"}, {"resolve.frag"});
  if (!ok) return tl::unexpected(ok.error());
  return result;
}

}  // namespace intaglio::render
