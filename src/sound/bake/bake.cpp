#include "sound/bake/bake.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "sound/bake/fem/elastic_system.h"
#include "sound/bake/radiation.h"

namespace intaglio::sound {

namespace {

using Eigen::MatrixXd;

// Interpolation of the ten nodes from the four corners: mid-edge nodes are halfway.
using Interpolation = Eigen::Matrix<double, 10, 4>;
Interpolation corner_interpolation() {
  Interpolation weights = Interpolation::Zero();
  weights.topRows<4>().setIdentity();
  for (int e = 0; e < 6; ++e) {
    for (const int corner : tet_edges[std::size_t(e)]) weights(4 + e, corner) = 0.5;
  }
  return weights;
}

// An edge of the shell, with the two vertices opposite to it; at a rim both are the same.
struct Hinge {
  int a, b, left, right;
  bool is_rim() const { return left == right; }
};

Result<std::vector<Hinge>> find_hinges(const BodySurface& surface, const std::string& name) {
  std::map<std::pair<int, int>, std::vector<int>> opposite;
  for (const Triangle& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) opposite[std::minmax(t[k], t[(k + 1) % 3])].push_back(t[(k + 2) % 3]);
  }
  std::vector<Hinge> hinges;
  for (const auto& [edge, sides] : opposite) {
    if (sides.size() > 2)
      return fail(name,
                  "has edges shared by more than two triangles, which a spring-mass shell does not allow",
                  "bake it as a solid, or repair the mesh");
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
    // Each triangle gives a third of its mass to each corner, half of that through each of the corner's
    // edges.
    element.mass(0, 0) = element.mass(1, 1) = material.density * thickness * areas / 6;
    if (h.is_rim()) return element;
    Eigen::Matrix<double, 12, 1> fold = Eigen::Matrix<double, 12, 1>::Zero();
    for (const int side : {2, 3}) {
      const Vec3& tip = at(side == 2 ? h.left : h.right);
      const double along = (tip - at(h.a)).dot(edge) / edge.squaredNorm();
      const Vec3 altitude = tip - at(h.a) - along * edge;
      // Both normals point to the same side of the surface.
      const Vec3 normal = (side == 2 ? edge.cross(altitude) : altitude.cross(edge)).normalized();
      const Vec3 rotation = normal / altitude.norm();
      fold.segment<3>(3 * side) += rotation;
      fold.segment<3>(0) -= (1 - along) * rotation;
      fold.segment<3>(3) -= along * rotation;
    }
    const double bending = material.youngs_modulus * std::pow(thickness, 3) /
                           (12 * (1 - material.poisson_ratio * material.poisson_ratio));
    element.stiffness += bending * edge.squaredNorm() / areas * fold * fold.transpose();
    return element;
  }
};

double surface_area(const ModalModel& model) {
  double area = 0;
  for (const Triangle& t : model.triangles) area += 0.5 * triangle_cross(model.points, t).norm();
  return area;
}

void copy_shapes(const Eigen::MatrixXd& shape, const std::vector<Eigen::Index>& ringing,
                 const std::vector<int>& nodes, ModalModel& model) {
  for (const int node : nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const Eigen::Index m : ringing) model.shapes.push_back(float(shape(3 * node + axis, m)));
    }
  }
}

Result<void> check_elements(const TetMesh& mesh) {
  if (mesh.tets.empty()) return fail("mesh", "it has no tetrahedra");
  for (const Tet10& tet : mesh.tets) {
    const ElementNodes nodes = element_nodes(mesh, tet);
    for (const QuadraturePoint& q : tet_quadrature()) {
      if (!(jacobian(nodes, q.barycentric) > 0)) {
        return fail("mesh", "has an inverted element", "curve the surface less, or use smaller elements");
      }
    }
  }
  return {};
}

}  // namespace

Hash bake_hash(const Material& m, const BakeOptions& options) {
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
  Renumbering number(mesh.nodes.size());
  const auto point = [&](int node) {
    return number(node, [&](std::size_t n) {
      surface.nodes.push_back(node);
      surface.points.push_back(mesh.nodes[n]);
    });
  };
  constexpr std::array<std::array<std::size_t, 3>, 4> quarters{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  for (const Triangle6& face : mesh.boundary) {
    for (const auto& [a, b, c] : quarters)
      surface.triangles.push_back({point(face[a]), point(face[b]), point(face[c])});
  }
  return surface;
}

Result<ModalModel> make_modal_model(const Modes& modes, ModalSurface surface, double mass,
                                    const Material& material, const BakeOptions& options) {
  ModalModel model;
  model.name = options.name;
  model.identity = options.identity;
  model.material = material;
  model.mass = mass;
  model.residual = modes.residual;
  std::vector<Eigen::Index> ringing;
  for (Eigen::Index m = 0; m < modes.angular_frequency.size(); ++m) {
    const double omega = modes.angular_frequency[m];
    const double d = rayleigh_damping(material, omega);
    if (d >= omega) continue;
    ringing.push_back(m);
    model.angular_frequency.push_back(omega);
    model.damping.push_back(d);
  }
  copy_shapes(modes.shape, ringing, surface.nodes, model);
  model.points = std::move(surface.points);
  model.triangles = std::move(surface.triangles);
  model.area = surface_area(model);
  const Eigen::RowVectorXd volume = volume_velocity(model);
  sample_surface(model, options.sample, options.modes.stop);
  if (stop_requested(options.modes.stop)) return bake_stopped();
  if (model.modes() > 0) model.radiation = mode_radiation(model, volume, surface.thickness);
  quantise_shapes(model);
  model.grid = TriangleGrid(model.points, model.triangles);
  return model;
}

Result<ModalModel> bake(const TetMesh& mesh, const Material& material, const BakeOptions& options) {
  if (auto valid = check_material(material); !valid) return tl::unexpected(valid.error());
  if (auto valid = check_elements(mesh); !valid) return tl::unexpected(valid.error());
  const auto modes = free_modes(assemble(mesh, material, options.modes.stop), options.modes);
  if (!modes) return tl::unexpected(modes.error());
  return make_modal_model(*modes, boundary_surface(mesh), material.density * volume(mesh), material, options);
}

Result<ModalModel> bake_linear(const TetMesh& mesh, const Material& material, const BakeOptions& options) {
  if (auto valid = check_material(material); !valid) return tl::unexpected(valid.error());
  Renumbering number(mesh.nodes.size());
  std::vector<std::array<int, 4>> corners;
  for (const Tet10& tet : mesh.tets) {
    std::array<int, 4>& own = corners.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) own[k] = number(tet[k], [](std::size_t) {});
  }
  const Interpolation weights = corner_interpolation();
  // Dynamic size: unrolled, the product below takes minutes to compile.
  MatrixXd interpolation_3d = MatrixXd::Zero(30, 12);
  for (int axis = 0; axis < 3; ++axis) {
    for (int a = 0; a < 10; ++a) {
      for (int b = 0; b < 4; ++b) interpolation_3d(3 * a + axis, 3 * b + axis) = weights(a, b);
    }
  }
  double mass = 0;
  const ElasticSystem system = assemble_elements<4>(
      std::size_t(number.used()), corners,
      [&](std::size_t e) {
        const ElementNodes curved = element_nodes(mesh, mesh.tets[e]);
        const ElementNodes nodes = curved.leftCols<4>() * weights.transpose();
        mass += material.density * element_volume(nodes);
        const MatrixXd ten_node_stiffness = element_stiffness(nodes, material);
        return ElementSystem<4>{interpolation_3d.transpose() * ten_node_stiffness * interpolation_3d,
                                weights.transpose() * element_mass(nodes, material.density) * weights};
      },
      options.modes.stop);
  auto modes = free_modes(system, options.modes);
  if (!modes) return tl::unexpected(modes.error());
  const MatrixXd corner_shapes = std::move(modes->shape);
  modes->shape = MatrixXd::Zero(3 * Eigen::Index(mesh.nodes.size()), corner_shapes.cols());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (int a = 0; a < 10; ++a) {
      MatrixXd rows = MatrixXd::Zero(3, corner_shapes.cols());
      for (int b = 0; b < 4; ++b) {
        if (weights(a, b) > 0)
          rows += weights(a, b) * corner_shapes.middleRows(3 * corners[e][std::size_t(b)], 3);
      }
      modes->shape.middleRows(3 * mesh.tets[e][std::size_t(a)], 3) = rows;
    }
  }
  return make_modal_model(*modes, boundary_surface(mesh), mass, material, options);
}

Result<ModalModel> bake_spring_shell(const BodySurface& surface, double thickness, const Material& material,
                                     const BakeOptions& options, const std::string& name) {
  if (auto valid = check_material(material); !valid) return tl::unexpected(valid.error());
  const auto hinges = find_hinges(surface, name);
  if (!hinges) return tl::unexpected(hinges.error());
  // Unreferenced vertices carry no mass.
  Renumbering number(surface.points.size());
  ModalSurface kept;
  kept.thickness = thickness;
  const auto point = [&](int p) {
    return number(p, [&](std::size_t n) {
      kept.nodes.push_back(int(kept.points.size()));
      kept.points.push_back(surface.points[n]);
    });
  };
  for (const auto& [a, b, c] : surface.triangles) kept.triangles.push_back({point(a), point(b), point(c)});
  std::vector<std::array<int, 4>> elements;
  for (const Hinge& h : *hinges) elements.push_back({point(h.a), point(h.b), point(h.left), point(h.right)});
  const ShellElements element{surface, material, thickness};
  const ElasticSystem system = assemble_elements<4>(
      kept.points.size(), elements, [&](std::size_t e) { return element((*hinges)[e]); }, options.modes.stop);
  const auto modes = free_modes(system, options.modes);
  if (!modes) return fail(name, modes.error().message(), "a spring-mass shell must be connected");
  // The area of a shell counts both of its sides.
  const double mass = material.density * thickness * 0.5 * surface.area;
  return make_modal_model(*modes, std::move(kept), mass, material, options);
}

namespace {

constexpr int rigid_modes = 6;  // also counted by Weyl's law
constexpr double elements_per_shear_wave = 4, elements_per_bending_wave = 5;

// Frequency below which a solid has `count` modes, by Weyl's law with a free surface:
//   N(x) = (4 pi / 3) V (2 + r^(-3/2)) x^3 + (pi / 4) A (2 - 3 r + 3 r^2) / (r (r - 1)) x^2,
// with x = f / c_s in waves per metre and r = (c_p / c_s)^2. The first term counts two shear waves and one
// pressure wave in the volume, the second what the surface adds: four in ten of a ball's first hundred modes.
// r > 4/3 for every Poisson ratio above -1. N(x) = count by bisection.
double solid_mode_frequency(double volume, double area, double shear_speed, double poisson_ratio, int count) {
  const double r = 2 * (1 - poisson_ratio) / (1 - 2 * poisson_ratio);
  const double in_volume = 4 * std::numbers::pi / 3 * volume * (2 + std::pow(r, -1.5));
  const double on_surface = std::numbers::pi / 4 * area * (2 - 3 * r + 3 * r * r) / (r * (r - 1));
  double low = 0, high = std::cbrt(count / in_volume);
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
  const double last = std::min(
      modes.max_frequency, solid_mode_frequency(volume, area, shear_speed, material.poisson_ratio, count));
  const double shear = shear_speed / last;
  // Bending wavelength^2 = (2 pi / sqrt(12)) c_plate thickness / f, and 2 pi / sqrt(12) is 1.8.
  const double bending = std::sqrt(1.8 * plate_speed * (2 * volume / area) / modes.max_frequency);
  const double last_bending = std::sqrt(std::numbers::pi * 0.5 * area / count);
  return std::max(std::min(shear / elements_per_shear_wave, bending / elements_per_bending_wave),
                  last_bending / elements_per_bending_wave);
}

}  // namespace intaglio::sound
