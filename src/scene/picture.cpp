#include "scene/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "contact/shape.h"
#include "core/hash.h"
#include "core/portable_math.h"
#include "intaglio/representation.h"

namespace intaglio::scene {

namespace {

// The box between the reliefs, cut 2 % of the depth below them to avoid z-fighting.
render::Mesh core_mesh(const contact::Box& box, const std::vector<SceneSurface>& reliefs) {
  double low = -box.half.y(), high = box.half.y();
  for (const SceneSurface& relief : reliefs) {
    const double depth = 1.02 * relief.surface->max_depth();
    (relief.surface->placement().n().y() > 0 ? high : low) -=
        relief.surface->placement().n().y() > 0 ? depth : -depth;
  }
  render::Mesh mesh = shape_mesh(contact::Box{{box.half.x(), 0.5 * (high - low), box.half.z()}});
  for (render::Vertex& v : mesh.vertices) v.position[1] += float(0.5 * (low + high));
  return mesh;
}

}  // namespace

ScenePicture::ScenePicture(const Scene& scene, const SceneSurface& all)
    : scene_(scene), part_poses_(1 + all.grounds.size()) {
  const SceneSurface& surface = given(all, Cue::picture);
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    add_body(k, k < surface.reliefs.size() ? surface.reliefs[k] : std::vector<SceneSurface>());
  for (std::size_t k = 0; k < surface.grounds.size(); ++k) {
    const auto& curved = surface.grounds[k].curved;
    if (!curved) continue;
    render::Solid back;
    back.mesh = std::make_shared<const render::Mesh>(back_mesh(
        curved->base().mesh(), 1.01 * surface.grounds[k].surface->max_depth(), scene.grounds[k].thickness));
    back.colour = Vec3(0.20, 0.17, 0.14);
    if (!back.mesh->vertices.empty()) solids_.push_back(std::move(back));
  }
}

void ScenePicture::add_body(std::size_t k, const std::vector<SceneSurface>& reliefs) {
  const BodySettings& body = scene_.bodies[k];
  BodyDrawing& drawing = drawings_.emplace_back();
  drawing.first_part = part_poses_.size();
  drawing.parts = reliefs.size();
  // Radius of the sphere of equal volume, (3 V / 4 pi)^(1/3).
  const double shadow = 0.62 * std::cbrt(contact::mass_properties(body.body.shape).volume);
  const bool has_skin = !reliefs.empty() && reliefs.front().curved;
  for (std::size_t n = 0; n < reliefs.size(); ++n)
    part_poses_.push_back({body.body.pose, has_skin ? shadow : 0});
  if (has_skin) return;
  const auto* box = std::get_if<contact::Box>(&body.body.shape);
  const bool has_core =
      box != nullptr && !reliefs.empty() && scene_.surface.representation == Representation::relief;
  render::Solid solid;
  solid.pose = body.body.pose;
  solid.mesh = shared(has_core ? core_mesh(*box, reliefs) : shape_mesh(body.body.shape));
  solid.colour = body.colour;
  solid.shadow_radius = shadow;
  drawing.solid = solids_.size();
  solids_.push_back(std::move(solid));
}

// Equal meshes are one: a thousand letters A are drawn together.
std::shared_ptr<const render::Mesh> ScenePicture::shared(render::Mesh mesh) {
  const auto bytes = [](const auto& list) { return std::as_bytes(std::span(list)); };
  const auto equal = [&](const auto& a, const auto& b) { return std::ranges::equal(bytes(a), bytes(b)); };
  Hash hash;
  for (const auto part : {bytes(mesh.vertices), bytes(mesh.indices)})
    hash.add_bytes(part.data(), part.size());
  const auto [first, last] = meshes_.equal_range(hash.value());
  for (auto at = first; at != last; ++at)
    if (equal(at->second->vertices, mesh.vertices) && equal(at->second->indices, mesh.indices))
      return at->second;
  return meshes_.emplace(hash.value(), std::make_shared<const render::Mesh>(std::move(mesh)))->second;
}

render::FrameScene ScenePicture::frame(std::span<const Pose> balls, std::span<const Pose> bodies,
                                       const std::optional<Vec3>& pen_tip) const {
  render::FrameScene frame;
  frame.camera.eye = scene_.camera.eye;
  frame.camera.target = scene_.camera.target;
  frame.camera.fov_y_degrees = scene_.camera.vertical_fov;
  frame.light.direction = scene_.light;
  frame.representation = scene_.surface.representation;
  for (std::size_t k = 0; k < balls.size(); ++k) {
    render::Ball ball;
    ball.pose = balls[k];
    ball.radius = scene_.balls[k].radius;
    if (scene_.balls[k].colour) ball.colour = *scene_.balls[k].colour;
    frame.balls.push_back(ball);
  }
  frame.solids = solids_;
  frame.part_poses = part_poses_;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodyDrawing& drawing = drawings_[k];
    if (drawing.solid) frame.solids[*drawing.solid].pose = bodies[k];
    for (std::size_t n = 0; n < drawing.parts; ++n) frame.part_poses[drawing.first_part + n].pose = bodies[k];
  }
  if (pen_tip && scene_.pen) {
    render::Pen pen;
    pen.tip = *pen_tip;
    pen.direction = scene_.pen->direction;
    pen.length = scene_.pen->length;
    pen.radius = scene_.pen->radius;
    frame.pen = pen;
  }
  return frame;
}

std::vector<render::SurfacePart> surface_parts(const Scene& scene, const SceneSurface& all) {
  const SceneSurface& surface = given(all, Cue::picture);
  std::vector<render::SurfacePart> parts;
  const auto add = [&](const SceneSurface& one, double thickness) {
    parts.push_back({.surface = one.surface.get(),
                     .slab_thickness = thickness,
                     .roughness = one.roughness,
                     .base = one.curved ? &one.curved->base().mesh() : one.quad.get()});
  };
  add(surface, scene.surface.thickness);
  for (std::size_t k = 0; k < surface.grounds.size(); ++k)
    add(surface.grounds[k], scene.grounds[k].thickness);
  for (const auto& reliefs : surface.reliefs)
    for (const SceneSurface& relief : reliefs) add(relief, 0.01);
  return parts;
}

Result<std::unique_ptr<render::Renderer>> make_renderer(const Scene& scene, const SceneSurface& all) {
  const SceneSurface& surface = given(all, Cue::picture);
  render::RendererOptions options;
  options.width = scene.video.width;
  options.height = scene.video.height;
  options.supersample = scene.video.supersample;
  options.slab_thickness = scene.surface.thickness;
  options.roughness = surface.roughness;
  auto renderer = render::Renderer::create(*surface.surface, options);
  if (!renderer) return tl::unexpected(renderer.error());
  const auto parts = surface_parts(scene, all);
  if (parts.size() == 1) return std::move(*renderer);  // it shows the floor already
  if (auto shown = (*renderer)->show(parts); !shown) return tl::unexpected(shown.error());
  return std::move(*renderer);
}

namespace {

using render::Mesh;

std::array<float, 3> floats(const Vec3& v) {
  return {float(v.x()), float(v.y()), float(v.z())};
}

void add_polygon(Mesh& mesh, std::span<const Vec3> corners, const Vec3& normal) {
  const auto first = std::uint32_t(mesh.vertices.size());
  for (const Vec3& corner : corners) mesh.vertices.push_back({floats(corner), floats(normal)});
  for (std::uint32_t k = 2; k < corners.size(); ++k)
    for (const std::uint32_t at : {first, first + k - 1, first + k}) mesh.indices.push_back(at);
}

Mesh box_mesh(const Vec3& half) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 n = Vec3::Zero(), a = Vec3::Zero(), b = Vec3::Zero();
      n[axis] = side;
      a[(axis + 1) % 3] = side;
      b[(axis + 2) % 3] = 1;
      const auto corner = [&](double s, double t) { return Vec3((n + s * a + t * b).cwiseProduct(half)); };
      const std::array<Vec3, 4> corners = {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
      add_polygon(mesh, corners, n);
    }
  }
  return mesh;
}

// lathe() builds along Z; capsules and cylinders lie along Y.
Mesh along_y(Mesh mesh) {
  for (render::Vertex& v : mesh.vertices) {
    v.position = {v.position[0], v.position[2], -v.position[1]};
    v.normal = {v.normal[0], v.normal[2], -v.normal[1]};
  }
  return mesh;
}

Mesh cylinder_mesh(double r, double h) {
  const std::array<render::ProfilePoint, 6> profile = {
      {{0, -h, 0, -1}, {r, -h, 0, -1}, {r, -h, 1, 0}, {r, h, 1, 0}, {r, h, 0, 1}, {0, h, 0, 1}}};
  return along_y(render::lathe(profile, 64));
}

Mesh capsule_mesh(double r, double h) {
  std::vector<render::ProfilePoint> profile;
  constexpr int stacks = 12;
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; k <= stacks; ++k) {
      const double angle = 0.5 * std::numbers::pi * (side < 0 ? k - stacks : k) / stacks;
      profile.push_back({r * elementary::cos(angle), side * h + r * elementary::sin(angle),
                         elementary::cos(angle), elementary::sin(angle)});
    }
  }
  return along_y(render::lathe(profile, 48));
}

Mesh polyhedron_mesh(const contact::Polyhedron& form) {
  Mesh mesh;
  for (const contact::Polyhedron::Face& face : form.faces) {
    std::vector<Vec3> corners;
    for (int k = 0; k < face.count; ++k)
      corners.push_back(form.vertices[std::size_t(form.loop[std::size_t(face.first + k)])]);
    add_polygon(mesh, corners, face.normal);
  }
  return mesh;
}

void append(Mesh& mesh, const Mesh& part, const Pose& pose) {
  const auto first = std::uint32_t(mesh.vertices.size());
  const auto vec = [](const std::array<float, 3>& f) { return Vec3(f[0], f[1], f[2]); };
  for (const render::Vertex& v : part.vertices)
    mesh.vertices.push_back(
        {floats(pose.to_world(vec(v.position))), floats(pose.orientation * vec(v.normal))});
  for (const std::uint32_t index : part.indices) mesh.indices.push_back(first + index);
}

struct MeshVisitor {
  Mesh operator()(const contact::Sphere& s) const { return capsule_mesh(s.radius, 0); }
  Mesh operator()(const contact::Capsule& s) const { return capsule_mesh(s.radius, s.half_height); }
  Mesh operator()(const contact::Box& s) const { return box_mesh(s.half); }
  Mesh operator()(const contact::Cylinder& s) const { return cylinder_mesh(s.radius, s.half_height); }
  Mesh operator()(const contact::ConvexHull& s) const { return s.form ? polyhedron_mesh(*s.form) : Mesh{}; }
  Mesh operator()(const contact::Mesh& s) const { return s.form ? polyhedron_mesh(*s.form) : Mesh{}; }
  Mesh operator()(const contact::Compound& s) const {
    Mesh mesh;
    for (const contact::CompoundChild& child : *s.children) append(mesh, shape_mesh(child.shape), child.pose);
    return mesh;
  }
};

}  // namespace

render::Mesh shape_mesh(const contact::Shape& shape) {
  return std::visit(MeshVisitor{}, shape);
}

namespace {

// Edges of one triangle only, after welding vertices that are duplicated along texture seams.
std::vector<std::array<int, 2>> boundary_edges(const surface::TriangleMesh& base) {
  using Place = std::tuple<double, double, double>;
  std::map<Place, int> welded;
  const auto name = [&](int k) {
    const Vec3& p = base.positions[std::size_t(k)];
    return welded.try_emplace({p.x(), p.y(), p.z()}, k).first->second;
  };
  std::map<std::array<int, 2>, std::array<int, 2>> unpaired;  // welded edge -> original vertices
  for (const surface::Triangle& t : base.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (unpaired.erase({name(b), name(a)}) == 0) unpaired[{name(a), name(b)}] = {a, b};
    }
  }
  std::vector<std::array<int, 2>> rim;
  for (const auto& [names, edge] : unpaired)
    if (names[0] != names[1]) rim.push_back(edge);
  return rim;
}

}  // namespace

render::Mesh back_mesh(const surface::TriangleMesh& base, double relief, double thickness) {
  const auto rim = boundary_edges(base);
  render::Mesh mesh;
  if (rim.empty()) return mesh;
  const auto at = [&](int k) { return std::size_t(k); };
  const auto offset = [&](int k, double by) {
    return Vec3(base.positions[at(k)] - by * base.normals[at(k)]);
  };
  for (std::size_t k = 0; k < base.positions.size(); ++k)
    mesh.vertices.push_back({floats(offset(int(k), thickness)), floats(-base.normals[k])});
  for (const surface::Triangle& t : base.triangles)
    for (const int k : {t[0], t[2], t[1]}) mesh.indices.push_back(std::uint32_t(k));
  for (const auto& [a, b] : rim) {
    const std::array<Vec3, 4> corners = {offset(a, relief), offset(a, thickness), offset(b, thickness),
                                         offset(b, relief)};
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalized();
    add_polygon(mesh, corners, normal);
  }
  return mesh;
}

}  // namespace intaglio::scene
