#include "sound/bake/bake.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <fmt/format.h>

#include "sound/bake/fem/elastic_system.h"
#include "sound/bake/radiation.h"

namespace intaglio::sound {

namespace {

using Eigen::MatrixXd;

// What ten nodes do when the four corners decide: middles are halfway.
using Follow = Eigen::Matrix<double, 10, 4>;
Follow follow_corners() {
  Follow follow = Follow::Zero();
  follow.topRows<4>().setIdentity();
  for (int e = 0; e < 6; ++e) {
    for (const int corner : tet_edges[std::size_t(e)]) follow(4 + e, corner) = 0.5;
  }
  return follow;
}

// An edge of the shell, with the two vertices opposite to it; at a rim the second is the first again.
struct Hinge {
  int a, b, left, right;
  bool is_rim() const { return left == right; }
};

Result<std::vector<Hinge>> hinges_of(const BodySurface& surface, const std::string& name) {
  std::map<std::pair<int, int>, std::vector<int>> opposite;
  for (const Triangle& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) opposite[std::minmax(t[k], t[(k + 1) % 3])].push_back(t[(k + 2) % 3]);
  }
  std::vector<Hinge> hinges;
  for (const auto& [edge, sides] : opposite) {
    if (sides.size() > 2)
      return fail(name, "has edges of more than two triangles, which no spring-mass shell has",
                  "bake it as a solid, or mend the mesh");
    hinges.push_back({edge.first, edge.second, sides.front(), sides.back()});
  }
  return hinges;
}

struct ShellElements {
  const BodySurface& surface;
  const Material& material;
  double thickness;

  const Vec3& at(int p) const { return surface.points[std::size_t(p)]; }
  double area(const Hinge& h, int side) const {
    return 0.5 * (at(h.b) - at(h.a)).cross(at(side) - at(h.a)).norm();
  }

  ElementSystem<4> operator()(const Hinge& h) const {
    ElementSystem<4> element{Eigen::Matrix<double, 12, 12>::Zero(), Eigen::Matrix4d::Zero()};
    const Vec3 edge = at(h.b) - at(h.a);
    Eigen::Matrix<double, 12, 1> stretch = Eigen::Matrix<double, 12, 1>::Zero();
    stretch.segment<3>(0) = -edge.normalized();
    stretch.segment<3>(3) = edge.normalized();
    element.stiffness += material.youngs_modulus * thickness * stretch * stretch.transpose();
    const double areas = area(h, h.left) + (h.is_rim() ? 0 : area(h, h.right));
    // Each triangle gives a third of its mass to a corner, half of that through each of the corner's edges.
    element.mass(0, 0) = element.mass(1, 1) = material.density * thickness * areas / 6;
    if (h.is_rim()) return element;
    Eigen::Matrix<double, 12, 1> fold = Eigen::Matrix<double, 12, 1>::Zero();
    for (const int side : {2, 3}) {
      const Vec3& tip = at(side == 2 ? h.left : h.right);
      const double along = (tip - at(h.a)).dot(edge) / edge.squaredNorm();
      const Vec3 altitude = tip - at(h.a) - along * edge;
      // Across the two triangles the normal keeps its side of the surface.
      const Vec3 normal = (side == 2 ? edge.cross(altitude) : altitude.cross(edge)).normalized();
      const Vec3 turn = normal / altitude.norm();
      fold.segment<3>(3 * side) += turn;
      fold.segment<3>(0) -= (1 - along) * turn;
      fold.segment<3>(3) -= along * turn;
    }
    const double bending = material.youngs_modulus * std::pow(thickness, 3) /
                           (12 * (1 - material.poisson_ratio * material.poisson_ratio));
    element.stiffness += bending * edge.squaredNorm() / areas * fold * fold.transpose();
    return element;
  }
};

double surface_area(const ModalModel& model) {
  double area = 0;
  for (const Triangle& t : model.triangles) {
    const Vec3& origin = model.points[std::size_t(t[0])];
    area += 0.5 *
            (model.points[std::size_t(t[1])] - origin).cross(model.points[std::size_t(t[2])] - origin).norm();
  }
  return area;
}

void take_shapes(const Eigen::MatrixXd& shape, const std::vector<Eigen::Index>& ringing,
                 const std::vector<int>& nodes, ModalModel& model) {
  for (const int node : nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const Eigen::Index m : ringing)
        model.shapes.push_back(static_cast<float>(shape(3 * node + axis, m)));
    }
  }
}

Result<void> check_elements(const TetMesh& mesh) {
  if (mesh.tets.empty()) return fail("mesh", "it has no tetrahedra");
  for (const Tet10& tet : mesh.tets) {
    const ElementNodes nodes = element_nodes(mesh, tet);
    for (const QuadraturePoint& q : tet_quadrature()) {
      if (!(jacobian(nodes, q.barycentric) > 0)) {
        return fail("mesh", "a tetrahedron is inside out", "curve the surface less, or use smaller elements");
      }
    }
  }
  return {};
}

}  // namespace

Hash bake_inputs(const Material& m, const BakeOptions& options) {
  Hash hash;
  hash.add(baker_version);
  hash.add(std::string_view(m.name));
  for (const double x : {m.density, m.youngs_modulus, m.poisson_ratio, m.rayleigh_alpha, m.rayleigh_beta,
                         m.friction, m.restitution, m.rolling_resistance, m.micro.rms_height,
                         m.micro.correlation_length, m.micro.spectral_slope, options.modes.min_frequency,
                         options.modes.max_frequency, options.sample.shape_error, options.sample.distance})
    hash.add(x);
  hash.add(options.modes.count);
  return hash;
}

Result<void> check_material(const Material& material) {
  const auto complain = [&](const char* what, const char* fix) -> Result<void> {
    return fail(fmt::format("material \"{}\"", material.name), what, fix);
  };
  if (!(material.density > 0)) return complain("its density is not positive", "give kg/m^3");
  if (!(material.youngs_modulus > 0)) return complain("its Young's modulus is not positive", "give Pa");
  if (!(material.poisson_ratio > -1 && material.poisson_ratio < 0.5)) {
    return complain("its Poisson ratio is out of range", "a Poisson ratio lies between -1 and 0.5");
  }
  if (!(material.rayleigh_alpha >= 0 && material.rayleigh_beta >= 0)) {
    return complain("its damping is negative", "Rayleigh alpha and beta are at least 0");
  }
  return {};
}

ModalSurface boundary_surface(const TetMesh& mesh) {
  ModalSurface surface;
  std::vector<int> number(mesh.nodes.size(), -1);
  const auto point = [&](int node) {
    int& n = number[std::size_t(node)];
    if (n < 0) {
      n = static_cast<int>(surface.nodes.size());
      surface.nodes.push_back(node);
      surface.points.push_back(mesh.nodes[std::size_t(node)]);
    }
    return n;
  };
  constexpr std::array<std::array<std::size_t, 3>, 4> quarters{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  for (const Triangle6& face : mesh.boundary) {
    for (const auto& [a, b, c] : quarters)
      surface.triangles.push_back({point(face[a]), point(face[b]), point(face[c])});
  }
  return surface;
}

ModalModel model_of_modes(const Modes& modes, ModalSurface surface, double mass, const Material& material,
                          const BakeOptions& options) {
  ModalModel model;
  model.name = options.name;
  model.source = options.source;
  model.material = material;
  model.mass = mass;
  model.residual = modes.residual;
  std::vector<Eigen::Index> ringing;
  for (Eigen::Index m = 0; m < modes.angular_frequency.size(); ++m) {
    const double omega = modes.angular_frequency[m];
    const double d = 0.5 * (material.rayleigh_alpha + material.rayleigh_beta * omega * omega);
    if (d >= omega) continue;
    ringing.push_back(m);
    model.angular_frequency.push_back(omega);
    model.damping.push_back(d);
  }
  take_shapes(modes.shape, ringing, surface.nodes, model);
  model.points = std::move(surface.points);
  model.triangles = std::move(surface.triangles);
  model.area = surface_area(model);
  const Eigen::RowVectorXd volume = volume_velocity(model);
  sample_surface(model, options.sample);
  if (model.modes() > 0) model.radiation = radiation_of(model, volume, surface.thickness);
  round_shapes(model);
  model.grid = TriangleGrid(model.points, model.triangles);
  return model;
}

Result<ModalModel> bake(const TetMesh& mesh, const Material& material, const BakeOptions& options) {
  if (auto valid = check_material(material); !valid) return tl::unexpected(valid.error());
  if (auto valid = check_elements(mesh); !valid) return tl::unexpected(valid.error());
  const auto modes = free_modes(assemble(mesh, material), options.modes);
  if (!modes) return tl::unexpected(modes.error());
  return model_of_modes(*modes, boundary_surface(mesh), material.density * volume(mesh), material, options);
}

Result<ModalModel> bake_linear(const TetMesh& mesh, const Material& material, const BakeOptions& options) {
  if (auto valid = check_material(material); !valid) return tl::unexpected(valid.error());
  std::vector<int> number(mesh.nodes.size(), -1);
  std::vector<std::array<int, 4>> corners;
  int count = 0;
  for (const Tet10& tet : mesh.tets) {
    std::array<int, 4>& own = corners.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      int& n = number[std::size_t(tet[k])];
      if (n < 0) n = count++;
      own[k] = n;
    }
  }
  TetMesh straight = mesh;
  const Follow follow = follow_corners();
  // Of dynamic size: unrolled, the product below takes minutes to compile.
  MatrixXd follow_axes = MatrixXd::Zero(30, 12);
  for (int axis = 0; axis < 3; ++axis) {
    for (int a = 0; a < 10; ++a) {
      for (int b = 0; b < 4; ++b) follow_axes(3 * a + axis, 3 * b + axis) = follow(a, b);
    }
  }
  double mass = 0;
  const ElasticSystem system = assemble_elements<4>(std::size_t(count), corners, [&](std::size_t e) {
    const ElementNodes whole = element_nodes(mesh, mesh.tets[e]);
    const ElementNodes nodes = whole.leftCols<4>() * follow.transpose();
    mass += material.density * element_volume(nodes);
    const MatrixXd of_ten = element_stiffness(nodes, material);
    return ElementSystem<4>{follow_axes.transpose() * of_ten * follow_axes,
                            follow.transpose() * element_mass(nodes, material.density) * follow};
  });
  auto modes = free_modes(system, options.modes);
  if (!modes) return tl::unexpected(modes.error());
  const MatrixXd of_corners = std::move(modes->shape);
  modes->shape = MatrixXd::Zero(3 * Eigen::Index(mesh.nodes.size()), of_corners.cols());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (int a = 0; a < 10; ++a) {
      MatrixXd rows = MatrixXd::Zero(3, of_corners.cols());
      for (int b = 0; b < 4; ++b) {
        if (follow(a, b) > 0) rows += follow(a, b) * of_corners.middleRows(3 * corners[e][std::size_t(b)], 3);
      }
      modes->shape.middleRows(3 * mesh.tets[e][std::size_t(a)], 3) = rows;
    }
  }
  return model_of_modes(*modes, boundary_surface(mesh), mass, material, options);
}

Result<ModalModel> bake_spring_shell(const BodySurface& surface, double thickness, const Material& material,
                                     const BakeOptions& options, const std::string& name) {
  if (auto valid = check_material(material); !valid) return tl::unexpected(valid.error());
  const auto hinges = hinges_of(surface, name);
  if (!hinges) return tl::unexpected(hinges.error());
  // Vertices that no triangle has are no masses.
  std::vector<int> number(surface.points.size(), -1);
  ModalSurface kept;
  kept.thickness = thickness;
  for (const Triangle& t : surface.triangles) {
    Triangle& own = kept.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      int& n = number[std::size_t(t[k])];
      if (n < 0) {
        n = static_cast<int>(kept.points.size());
        kept.points.push_back(surface.points[std::size_t(t[k])]);
        kept.nodes.push_back(n);
      }
      own[k] = n;
    }
  }
  std::vector<std::array<int, 4>> elements;
  for (const Hinge& h : *hinges)
    elements.push_back({number[std::size_t(h.a)], number[std::size_t(h.b)], number[std::size_t(h.left)],
                        number[std::size_t(h.right)]});
  const ShellElements element{surface, material, thickness};
  const ElasticSystem system = assemble_elements<4>(kept.points.size(), elements,
                                                    [&](std::size_t e) { return element((*hinges)[e]); });
  const auto modes = free_modes(system, options.modes);
  if (!modes) return fail(name, modes.error().message(), "a spring-mass shell must be of one piece");
  // Of a shell the surface counts both of its sides.
  const double mass = material.density * thickness * 0.5 * surface.area;
  return model_of_modes(*modes, std::move(kept), mass, material, options);
}

namespace {

constexpr int rigid_modes = 6;                                // which the law counts too
constexpr double in_a_shear_wave = 4, in_a_bending_wave = 5;  // elements

// Below which a solid has `count` modes by Weyl's law: of shear and pressure waves in its volume, and those
// that its free surface adds, four in ten of a ball's first hundred.
double last_of_solid(double volume, double area, double shear_speed, double poisson_ratio, int count) {
  const double r = 2 * (1 - poisson_ratio) / (1 - 2 * poisson_ratio);  // of speeds squared, pressure to shear
  const double in_volume = 4 * std::numbers::pi / 3 * volume * (2 + std::pow(r, -1.5));
  const double on_surface = std::numbers::pi / 4 * area * (2 - 3 * r + 3 * r * r) / (r * (r - 1));
  double low = 0, high = std::cbrt(count / in_volume);  // in waves a metre
  for (int k = 0; k < 50; ++k) {
    const double x = 0.5 * (low + high);
    (in_volume * x * x * x + on_surface * x * x < count ? low : high) = x;
  }
  return shear_speed * high;
}

}  // namespace

double element_size(double volume, double area, const Material& material, const ModeOptions& modes) {
  const int count = modes.count + rigid_modes;
  const double shear_speed = std::sqrt(material.shear_modulus() / material.density);
  const double plate_speed = std::sqrt(material.youngs_modulus / material.density /
                                       (1 - material.poisson_ratio * material.poisson_ratio));
  const double last =
      std::min(modes.max_frequency, last_of_solid(volume, area, shear_speed, material.poisson_ratio, count));
  const double shear = shear_speed / last;
  const double bending = std::sqrt(1.8 * plate_speed * (2 * volume / area) / modes.max_frequency);
  const double last_bending = std::sqrt(std::numbers::pi * 0.5 * area / count);
  return std::max(std::min(shear / in_a_shear_wave, bending / in_a_bending_wave),
                  last_bending / in_a_bending_wave);
}

}  // namespace intaglio::sound
