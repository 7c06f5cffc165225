#include "intaglio/sound/modal_model.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "intaglio/sound/fem/element.h"
#include "intaglio/sound/model_of_modes.h"
#include "intaglio/sound/radiation.h"
#include "intaglio/sound/sample_surface.h"

namespace intaglio::sound {

namespace {

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

std::vector<float> shape_units(const ModalModel& model) {
  const auto modes = std::size_t(model.modes());
  std::vector<float> units(modes, 0.0f);
  for (auto row = model.shapes.begin(); row != model.shapes.end(); row += std::ptrdiff_t(modes)) {
    for (std::size_t m = 0; m < modes; ++m) units[m] = std::max(units[m], std::abs(row[std::ptrdiff_t(m)]));
  }
  for (float& unit : units) {
    int exponent = 0;
    // The largest is below 2^exponent; 15 bits and a sign hold multiples of 2^(exponent - 15) below it.
    std::frexp(unit, &exponent);
    unit = unit >= 0x1p-100f ? std::ldexp(1.0f, exponent - 15) : 1.0f;  // less than that is nothing
  }
  return units;
}

void round_shapes(ModalModel& model) {
  const std::vector<float> units = shape_units(model);
  const std::vector<std::int16_t> whole = rounded_shapes(model, units);
  for (std::size_t k = 0; k < whole.size();) {
    for (const float unit : units) {
      model.shapes[k] = float(whole[k]) * unit;
      ++k;
    }
  }
}

std::vector<std::int16_t> rounded_shapes(const ModalModel& model, std::span<const float> units) {
  std::vector<std::int16_t> whole;
  whole.reserve(model.shapes.size());
  for (std::size_t k = 0; k < model.shapes.size();) {
    for (const float unit : units)
      whole.push_back(static_cast<std::int16_t>(
          std::clamp(std::nearbyint(model.shapes[k++] / unit), -32767.0f, 32767.0f)));
  }
  return whole;
}

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

Vec3 ModalModel::shape(int point, int mode) const {
  const auto n = static_cast<std::size_t>(modes());
  const float* const x = shapes.data() + std::size_t(point) * 3 * n + std::size_t(mode);
  return {x[0], x[n], x[2 * n]};
}

void ModalModel::gains(const Vec3& point_local, const Vec3& direction_local, std::span<float> out) const {
  assert(out.size() <= angular_frequency.size());
  if (out.empty()) return;
  const TrianglePoint at = grid.nearest(point_local, points, triangles);
  std::fill(out.begin(), out.end(), 0.0f);
  for (int corner = 0; corner < 3; ++corner) {
    const auto point = static_cast<std::size_t>(triangles[std::size_t(at.triangle)][std::size_t(corner)]);
    for (int axis = 0; axis < 3; ++axis) {
      const auto weight = static_cast<float>(at.barycentric[corner] * direction_local[axis]);
      const float* const row = shapes.data() + (3 * point + std::size_t(axis)) * angular_frequency.size();
      for (std::size_t m = 0; m < out.size(); ++m) out[m] += weight * row[m];
    }
  }
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

}  // namespace intaglio::sound
