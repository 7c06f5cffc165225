#include "intaglio/session/shape_mesh.h"

#include <array>
#include <numbers>

#include "intaglio/core/elementary.h"

namespace intaglio::session {

namespace {

using render::Mesh;

std::array<float, 3> floats(const Vec3& v) {
  return {float(v.x()), float(v.y()), float(v.z())};
}

void add_polygon(Mesh& mesh, std::span<const Vec3> corners, const Vec3& normal) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& corner : corners) mesh.vertices.push_back({floats(corner), floats(normal)});
  for (std::uint32_t k = 2; k < corners.size(); ++k)
    for (const std::uint32_t at : {first, first + k - 1, first + k}) mesh.indices.push_back(at);
}

Mesh box(const Vec3& half) {
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

// Lathes stand along Z; capsules and cylinders along Y.
Mesh along_y(Mesh mesh) {
  for (render::Vertex& v : mesh.vertices) {
    v.position = {v.position[0], v.position[2], -v.position[1]};
    v.normal = {v.normal[0], v.normal[2], -v.normal[1]};
  }
  return mesh;
}

Mesh cylinder(double r, double h) {
  const std::array<render::ProfilePoint, 6> profile = {
      {{0, -h, 0, -1}, {r, -h, 0, -1}, {r, -h, 1, 0}, {r, h, 1, 0}, {r, h, 0, 1}, {0, h, 0, 1}}};
  return along_y(render::lathe(profile, 64));
}

Mesh capsule(double r, double h) {
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

Mesh polyhedron(const contact::Polyhedron& form) {
  Mesh mesh;
  for (const contact::Polyhedron::Face& face : form.faces) {
    std::vector<Vec3> corners;
    for (int k = 0; k < face.count; ++k)
      corners.push_back(
          form.vertices[static_cast<std::size_t>(form.loop[static_cast<std::size_t>(face.first + k)])]);
    add_polygon(mesh, corners, face.normal);
  }
  return mesh;
}

void append(Mesh& mesh, const Mesh& part, const Pose& pose) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto vec = [](const std::array<float, 3>& f) { return Vec3(f[0], f[1], f[2]); };
  for (const render::Vertex& v : part.vertices)
    mesh.vertices.push_back(
        {floats(pose.to_world(vec(v.position))), floats(pose.orientation * vec(v.normal))});
  for (const std::uint32_t index : part.indices) mesh.indices.push_back(first + index);
}

struct MeshOf {
  Mesh operator()(const contact::Sphere& s) const { return capsule(s.radius, 0); }
  Mesh operator()(const contact::Capsule& s) const { return capsule(s.radius, s.half_height); }
  Mesh operator()(const contact::Box& s) const { return box(s.half); }
  Mesh operator()(const contact::Cylinder& s) const { return cylinder(s.radius, s.half_height); }
  Mesh operator()(const contact::ConvexHull& s) const { return s.form ? polyhedron(*s.form) : Mesh{}; }
  Mesh operator()(const contact::Mesh& s) const { return s.form ? polyhedron(*s.form) : Mesh{}; }
  Mesh operator()(const contact::Compound& s) const {
    Mesh mesh;
    for (const contact::CompoundChild& child : *s.children) append(mesh, shape_mesh(child.shape), child.pose);
    return mesh;
  }
};

}  // namespace

render::Mesh shape_mesh(const contact::Shape& shape) {
  return std::visit(MeshOf{}, shape);
}

}  // namespace intaglio::session
