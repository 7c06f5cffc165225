#include "sound/bake/radiation.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "sound/bake/fem/tet_mesh.h"
#include "sound/bake/near_field.h"
#include "sound/bake/sample_surface.h"
#include "sound/modal_model.h"

namespace intaglio::sound {

namespace {

// The surface pressure p_s = rho c (Re z u + i (Im z / s) Phi), for velocities as e^(i omega t):
//
// - Slow limit, x = k s << 1: the air before the surface is incompressible, and p_s = rho dPhi/dt, which is
//   i omega rho Phi. In the formula z -> i x (the root of -1 is -i), so Im z / s -> k and
//   p_s -> i rho c k Phi, the same.
// - Fast limit, x >> 1: z -> 1 and p_s -> rho c u, as before a plane wave; Im z / s -> 0 takes Phi away.
// - Plane wave of wave number k_p over an infinite plane: incompressible air has Phi = u / k_p, so
//   s = 1 / k_p. The exact p_s / (rho c u) is k / sqrt(k^2 - k_p^2) = x / sqrt(x^2 - 1), which is z for
//   eta = 0, and eta is 0 since a is infinite.
// - Pulsating sphere: Phi = a u, so s = a and eta = 1. The exact ratio is i k a / (1 + i k a) = x / (x - i),
//   and x^2 - 1 - 2 i x = (x - i)^2, which makes z the same.
// - Order n of a sphere: s = a / (n + 1), so the transition lies at k a = n + 1, where it should. Its
//   relative width is that of Airy's function at the turning point of a spherical Hankel function,
//   (n + 1)^(-2/3), and that is eta = (s / a)^(2/3).
//
// In between z is an interpolation; radiation.h has its errors.
//
// Above x = supersonic radiation is complete: the power is rho c Re z sum of A u^2. A power P is
// 4 pi p^2 / (rho c) at 1 m, so p^2 = (rho c)^2 Re z sum of A u^2 / (4 pi).

constexpr int min_directions = 64, max_directions = 256;  // each used with its opposite
constexpr double supersonic = 1.4;                        // x: above it radiation is complete
constexpr std::size_t max_points = 600;                   // of a surface whose near field is solved
// Phase across a triangle, in radians, that the integral can resolve: the wave number is capped there.
constexpr double max_phase = 2;

// A Fibonacci spiral: even over half of all directions.
Vec3 direction(int k, int directions) {
  const double z = (k + 0.5) / directions, turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// The direction that weights modes of equal frequency. It lies in no plane of symmetry of a body whose axes
// are those of its frame.
Vec3 reference_direction() {
  return Vec3(0.5137, 0.7219, 0.4636).normalized();
}

struct Facets {
  Eigen::Matrix3Xd middle, normal;
  Eigen::VectorXd area;
};

Facets make_facets(const VibratingSurface& surface) {
  const auto count = Eigen::Index(surface.triangles.size());
  Facets f{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count), Eigen::VectorXd(count)};
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto corner = [&](std::size_t k) {
      return surface.points[std::size_t(surface.triangles[std::size_t(j)][k])];
    };
    const Vec3 cross = triangle_cross(surface.points, surface.triangles[std::size_t(j)]);
    f.middle.col(j) = (corner(0) + corner(1) + corner(2)) / 3;
    f.normal.col(j) = cross.normalized();
    f.area[j] = 0.5 * cross.norm();
  }
  f.middle.colwise() -= Vec3(f.middle * f.area / f.area.sum());
  return f;
}

// A vibration at one frequency: normal velocity, and surface pressure in phase with it and in quadrature.
struct Source {
  double k = 0;
  Eigen::VectorXd velocity, in_phase, out_of_phase;
};

// The sum of A e^(i k e.x) (rho c u + e.n p_s) towards e is even + odd, towards -e even - odd, since the
// phase and e.n change sign. So the mean of both squares is |even|^2 + |odd|^2.
struct FarField {
  std::complex<double> even, odd;
};
FarField far_field(const Vec3& e, const Facets& f, const Source& source) {
  double even_re = 0, even_im = 0, odd_re = 0, odd_im = 0;
  for (Eigen::Index j = 0; j < source.velocity.size(); ++j) {
    const double phase = source.k * e.dot(f.middle.col(j)), facing = e.dot(f.normal.col(j)) * f.area[j];
    const double c = std::cos(phase), s = std::sin(phase),
                 flow = air_density * speed_of_sound * f.area[j] * source.velocity[j];
    // Towards e (c + i s)(flow + facing p), towards -e (c - i s)(flow - facing p).
    even_re += c * flow - s * facing * source.out_of_phase[j];
    even_im += s * facing * source.in_phase[j];
    odd_re += c * facing * source.in_phase[j];
    odd_im += s * flow + c * facing * source.out_of_phase[j];
  }
  return {{even_re, even_im}, {odd_re, odd_im}};
}

// Mean square over all directions.
double mean_square(const Facets& f, const Source& source) {
  const double reach = std::sqrt(f.middle.colwise().squaredNorm().maxCoeff());
  // Beams are as narrow as a wavelength over the body's size.
  const int directions =
      int(std::clamp(std::pow(0.5 * source.k * reach, 2), double(min_directions), double(max_directions)));
  double sum = 0;
  for (int d = 0; d < directions; ++d) {
    const FarField t = far_field(direction(d, directions), f, source);
    sum += std::norm(t.even) + std::norm(t.odd);
  }
  return sum / directions;
}

// z of the derivation above, from x = k s and s / a.
std::complex<double> wave_impedance(double x, double s_over_a) {
  return x / std::sqrt(std::complex<double>(x * x - 1, -2 * std::cbrt(s_over_a * s_over_a) * x));
}

Vec3 area_vector(const std::vector<Vec3>& points, const Triangle& t) {
  return 0.5 * triangle_cross(points, t);
}

// Boundary edges of an open surface: sides that no other triangle has in the opposite direction.
std::vector<std::pair<int, int>> boundary_edges(const std::vector<Triangle>& triangles) {
  std::map<std::pair<int, int>, int> sides;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  }
  std::vector<std::pair<int, int>> rim;
  for (const auto& [side, uses] : sides) {
    if (!sides.contains({side.second, side.first})) rim.push_back(side);
  }
  return rim;
}

// Removes the walls of internal cavities, and unreferenced points.
void remove_cavities(ModalModel& model) {
  model.triangles = outer_triangles(model.points, model.triangles);
  Renumbering number(model.points.size());
  std::vector<Vec3> points;
  std::vector<float> shapes;
  const auto row = 3 * std::size_t(model.modes());
  const auto copy = [&](std::size_t point) {
    points.push_back(model.points[point]);
    const auto first = model.shapes.begin() + std::ptrdiff_t(point * row);
    shapes.insert(shapes.end(), first, first + std::ptrdiff_t(row));
  };
  for (Triangle& t : model.triangles) {
    for (int& p : t) p = number(p, copy);
  }
  model.points = std::move(points);
  model.shapes = std::move(shapes);
}

// Replaces a sheet by its two sides, `thickness` apart, joined along the rim; both move as the sheet's
// points.
void thicken_sheet(ModalModel& model, double thickness) {
  const std::vector<std::pair<int, int>> rim = boundary_edges(model.triangles);
  std::vector<Vec3> normal(model.points.size(), Vec3::Zero());
  for (const Triangle& t : model.triangles) {
    for (const int p : t) normal[std::size_t(p)] += area_vector(model.points, t);
  }
  const std::size_t points = model.points.size(), triangles = model.triangles.size();
  for (std::size_t p = 0; p < points; ++p) {
    const Vec3 half = 0.5 * thickness * normal[p].stableNormalized();
    model.points.push_back(model.points[p] - half);
    model.points[p] += half;
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto [a, b, c] = model.triangles[t];
    const int back = int(points);
    model.triangles.push_back({a + back, c + back, b + back});
  }
  for (const auto& [a, b] : rim) {
    const int back = int(points);
    model.triangles.push_back({b, a, a + back});
    model.triangles.push_back({b, a + back, b + back});
  }
  const std::vector<float> one_side = model.shapes;
  model.shapes.insert(model.shapes.end(), one_side.begin(), one_side.end());
}

}  // namespace

std::vector<double> radiated_pressure(const VibratingSurface& surface, std::span<const double> omega,
                                      const Eigen::MatrixXd& coherence) {
  const Eigen::MatrixXd potential =
      incompressible_potential(surface.points, surface.triangles, surface.velocity);
  const Facets f = make_facets(surface);
  const double max_wave_number = max_phase / std::sqrt(f.area.sum() / double(f.area.size()));
  const double reach = std::sqrt(f.area.sum() / (4 * std::numbers::pi));
  const double impedance = air_density * speed_of_sound;
  // <u, u> and <u, Phi> of each vibration and those coherent with it: traces, which no rotation among them
  // changes.
  const Eigen::VectorXd squares = (f.area.transpose() * surface.velocity.cwiseAbs2()).transpose();
  const Eigen::VectorXd products =
      (f.area.transpose() * surface.velocity.cwiseProduct(potential)).transpose();
  const Eigen::VectorXd group_squares = coherence * squares, group_products = coherence * products;
  Eigen::VectorXd mean(surface.velocity.cols()), toward_listener(surface.velocity.cols());
  for (Eigen::Index m = 0; m < surface.velocity.cols(); ++m) {
    const double k = std::min(omega[std::size_t(m)] / speed_of_sound, max_wave_number);
    const double s = group_squares[m] > 0 ? std::max(0.0, group_products[m] / group_squares[m]) : 0;
    const std::complex<double> z = wave_impedance(k * s, s / reach);
    const double out_of_phase = s > 0 ? z.imag() / (k * s) : 1;
    const Source source{k, surface.velocity.col(m), z.real() * impedance * surface.velocity.col(m),
                        out_of_phase * k * impedance * potential.col(m)};
    const double per_sum = k / (4 * std::numbers::pi);
    mean[m] = k * s > supersonic ? impedance * impedance * z.real() * squares[m] / (4 * std::numbers::pi)
                                 : per_sum * per_sum * mean_square(f, source);
    const FarField t = far_field(reference_direction(), f, source);
    // The sum of both parts is a linear functional of the shape, which the modulus is not.
    toward_listener[m] = per_sum * ((t.even + t.odd).real() + (t.even + t.odd).imag());
  }
  const Eigen::VectorXd group_mean = coherence * mean;
  const Eigen::VectorXd group_toward_listener = coherence * toward_listener.cwiseAbs2();
  std::vector<double> pressure;
  for (Eigen::Index m = 0; m < toward_listener.size(); ++m) {
    // Zero towards the listener for a body with purely tangential motion.
    pressure.push_back(group_toward_listener[m] > 0
                           ? toward_listener[m] * std::sqrt(group_mean[m] / group_toward_listener[m])
                           : std::sqrt(mean[m]));
  }
  return pressure;
}

std::vector<double> radiated_pressure(const VibratingSurface& surface, std::span<const double> omega) {
  const auto count = Eigen::Index(omega.size());
  std::vector<double> pressure = radiated_pressure(surface, omega, Eigen::MatrixXd::Identity(count, count));
  for (double& p : pressure) p = std::abs(p);
  return pressure;
}

Eigen::RowVectorXd volume_velocity(const ModalModel& model) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(model.modes());
  for (const Triangle& t : outer_triangles(model.points, model.triangles)) {
    const Vec3 n = area_vector(model.points, t) / 3;
    for (int m = 0; m < model.modes(); ++m) {
      for (const int p : t) sum[m] += n.dot(model.shape(p, m));
    }
  }
  return sum;
}

std::vector<double> mode_radiation(const ModalModel& model, const Eigen::RowVectorXd& volume,
                                   double thickness) {
  ModalModel coarse = model;
  const bool is_sheet = thickness > 0 && !boundary_edges(model.triangles).empty();
  if (!is_sheet) remove_cavities(coarse);
  SampleOptions sample;
  for (int round = 0; round < 5 && coarse.points.size() > max_points; ++round) {
    sample = {2 * sample.shape_error, 2 * sample.distance};
    sample_surface(coarse, sample);
  }
  if (is_sheet) thicken_sheet(coarse, thickness);
  coarse.triangles = outer_triangles(coarse.points, coarse.triangles);
  VibratingSurface surface{coarse.points, coarse.triangles,
                           Eigen::MatrixXd(Eigen::Index(coarse.triangles.size()), coarse.modes())};
  double area = 0;
  for (Eigen::Index j = 0; j < surface.velocity.rows(); ++j) {
    const Triangle& t = coarse.triangles[std::size_t(j)];
    const Vec3 n = area_vector(coarse.points, t);
    area += n.norm();
    for (int m = 0; m < coarse.modes(); ++m)
      surface.velocity(j, m) =
          n.normalized().dot(coarse.shape(t[0], m) + coarse.shape(t[1], m) + coarse.shape(t[2], m)) / 3;
  }
  if (!is_sheet) surface.velocity.rowwise() += ((volume - volume_velocity(coarse)) / area).eval();
  coarse.radiation =
      radiated_pressure(surface, model.angular_frequency, coherence(model.angular_frequency, model.damping));
  limit_radiation(coarse);
  return coarse.radiation;
}

}  // namespace intaglio::sound
