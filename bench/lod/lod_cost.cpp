#include "bench/lod/lod_cost.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "bench/floors.h"
#include "bench/timing.h"
#include "core/portable_math.h"
#include "intaglio/representation.h"
#include "mesh/triangle_search.h"
#include "render/mesh.h"
#include "render/renderer.h"

namespace intaglio::bench {

namespace {

constexpr double ball_radius = 0.1;  // m
constexpr int balls = 100, stroke_samples = 4000;

Floor floor_of(const LodWay& way, const SharedSurface& full) {
  if (way.texture) {
    Floor out = textured("texture", way.texture, {});
    out.surface = full;
    return out;
  }
  Floor out{"mesh", 0, 0, 0, true, full, {}, {}, {}};
  out.triangles = std::make_unique<btTriangleMesh>();
  for (const Vec3& local : way.mesh.positions) {
    const Vec3 at = full->placement().to_world(local);
    out.triangles->findOrAddVertex({btScalar(at.x()), btScalar(at.y()), btScalar(at.z())}, false);
  }
  for (const auto& t : way.mesh.triangles) out.triangles->addTriangleIndices(t[0], t[1], t[2]);
  out.shape = std::make_unique<btBvhTriangleMeshShape>(out.triangles.get(), true);
  return out;
}

std::shared_ptr<const render::Mesh> drawn(const LodMesh& mesh, const surface::Placement& placement) {
  auto out = std::make_shared<render::Mesh>();
  const auto floats = [](const Vec3& v) {
    return std::array<float, 3>{float(v.x()), float(v.y()), float(v.z())};
  };
  for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
    out->vertices.push_back({floats(placement.to_world(mesh.positions[k])),
                             floats(placement.direction_to_world(mesh.normals[k]))});
  }
  for (const auto& triangle : mesh.triangles)
    for (const int vertex : triangle) out->indices.push_back(std::uint32_t(vertex));
  return out;
}

// A way with everything that its senses need.
struct Course {
  Course(const LodWay& way, const SharedSurface& full) : floor(floor_of(way, full)), world(floor) {
    for (int k = 0; k < balls; ++k) world.add(ball);
  }

  Floor floor;
  btSphereShape ball{btScalar(ball_radius)};
  FloorWorld world;
  std::unique_ptr<render::Renderer> renderer;  // draws a texture
  std::shared_ptr<const render::Mesh> drawn;
  std::optional<surface::UvGrid> places;  // a mesh's triangles by texture coordinate
  std::vector<Vec2> slopes;               // one a triangle of the mesh
  std::vector<double> picture_ms, contact_us, sound_ns;
};

render::RendererOptions small() {
  render::RendererOptions out;
  out.width = 320;
  out.height = 180;
  out.supersample = 1;
  return out;
}

// As in bench_render, four times as far, since the brick is four times as large.
std::array<render::Camera, 3> cameras() {
  std::array<render::Camera, 3> out;
  out[0].eye = 4 * Vec3(0.05, 0.9, 0.35);
  out[1].eye = 4 * Vec3(0.05, 0.48, 0.62);
  out[2].eye = 4 * Vec3(0.3, 0.12, 0.7);
  out[2].target = 4 * Vec3(0, 0, 0.1);
  return out;
}

Result<void> prepare(Course& course, const LodWay& way, const SharedSurface& full) {
  if (way.texture) {
    auto renderer = render::Renderer::create(*way.texture, small());
    if (!renderer) return tl::unexpected(renderer.error());
    course.renderer = std::move(*renderer);
    return {};
  }
  course.drawn = drawn(way.mesh, full->placement());
  TriangleMesh mesh;
  mesh.positions = way.mesh.positions;
  mesh.uvs = way.mesh.uvs;
  mesh.triangles = way.mesh.triangles;
  course.places.emplace(mesh);
  for (const auto& t : way.mesh.triangles) {
    const auto corner = [&](std::size_t k) { return way.mesh.positions[std::size_t(t[k])]; };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    course.slopes.emplace_back(-normal.x() / normal.z(), -normal.y() / normal.z());
  }
  return {};
}

// `nothing` draws meshes: its own surface is out of sight.
void draw(Course& course, render::Renderer& nothing) {
  render::FrameScene scene;
  render::Renderer& renderer = course.renderer ? *course.renderer : nothing;
  if (course.drawn) scene.solids.push_back({{}, course.drawn});
  renderer.draw(scene);  // uploads
  for (const render::Camera& camera : cameras()) {
    scene.camera = camera;
    const double start = process_seconds();
    renderer.draw(scene);
    course.picture_ms.push_back(1e3 * (process_seconds() - start));
  }
}

volatile double sink = 0;

// A mesh's triangle is found by its texture coordinate, on a grid, which is faster than by its nearest point.
void scrape(Course& course, const LodWay& way, int round) {
  Random random(3000 + std::uint64_t(round));
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  const Vec2 along(std::cos(angle), std::sin(angle));
  std::vector<Vec2> uvs;
  for (int k = 0; k < stroke_samples; ++k)
    uvs.push_back(Vec2(0.5, 0.5) + (k / 44'100.0 / floor_side) * along);
  double sum = 0;
  const double start = cpu_seconds();
  if (way.texture) {
    for (const Vec2& uv : uvs) sum += way.texture->smooth(uv).gradient.dot(along);
  } else {
    for (const Vec2& uv : uvs) {
      const auto hit = course.places->find(uv);
      if (!hit) continue;
      const Vec2 slope = course.slopes[std::size_t(hit->triangle)];
      sum += slope.dot(along);
    }
  }
  course.sound_ns.push_back(1e9 * (cpu_seconds() - start) / stroke_samples);
  sink = sink + sum;
}

}  // namespace

Result<std::vector<LodCost>> lod_costs(const std::shared_ptr<const surface::Surface>& full,
                                       const std::vector<LodWay>& ways, int rounds) {
  const surface::Placement out_of_sight(Vec3(0, -1000, 0), Quat::Identity(), 1, 1);
  auto nothing = render::Renderer::create(full->placed(out_of_sight, 0.01), small());
  if (!nothing) return tl::unexpected(nothing.error());
  std::vector<std::unique_ptr<Course>> courses;
  for (const LodWay& way : ways) {
    courses.push_back(std::make_unique<Course>(way, full));
    if (auto ready = prepare(*courses.back(), way, full); !ready) return tl::unexpected(ready.error());
  }
  for (int round = 0; round < rounds; ++round) {
    for (const auto& course : courses) draw(*course, **nothing);
    for (const auto& course : courses)
      roll_balls(course->world, course->floor, ball_radius, 1000 + std::uint64_t(round), course->contact_us);
    for (std::size_t k = 0; k < ways.size(); ++k) scrape(*courses[k], ways[k], round);
  }
  std::vector<LodCost> out;
  for (const auto& course : courses) {
    out.push_back({summary(course->picture_ms).median, summary(course->contact_us).median,
                   summary(course->sound_ns).median});
  }
  return out;
}

}  // namespace intaglio::bench
