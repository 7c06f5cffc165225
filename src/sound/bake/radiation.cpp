#include "sound/bake/radiation.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "sound/bake/near_field.h"
#include "sound/bake/sample_surface.h"
#include "sound/modal_model.h"

namespace intaglio::sound {

namespace {

constexpr int fewest_directions = 64, most_directions = 256;  // and as many opposites
constexpr double supersonic = 1.4;  // times the wave number of the shape: from there on all of it gets away
constexpr std::size_t most_points = 600;  // of a surface whose near field is solved
// In radians across a triangle: beyond, what is radiated no longer depends on the frequency.
constexpr double finest_phase = 2;

// Evenly over half of all directions: a Fibonacci spiral.
Vec3 direction(int k, int directions) {
  const double z = (k + 0.5) / directions, turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// The direction from which modes of one frequency are heard. It lies in no plane of symmetry of a body whose
// axes are those of its frame.
Vec3 listening_direction() {
  return Vec3(0.5137, 0.7219, 0.4636).normalized();
}

struct Facets {
  Eigen::Matrix3Xd middle, normal;
  Eigen::VectorXd area;
};

Facets facets_of(const VibratingSurface& surface) {
  const auto count = Eigen::Index(surface.triangles.size());
  Facets f{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count), Eigen::VectorXd(count)};
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto corner = [&](std::size_t k) {
      return surface.points[std::size_t(surface.triangles[std::size_t(j)][k])];
    };
    const Vec3 cross = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    f.middle.col(j) = (corner(0) + corner(1) + corner(2)) / 3;
    f.normal.col(j) = cross.normalized();
    f.area[j] = 0.5 * cross.norm();
  }
  f.middle.colwise() -= Vec3(f.middle * f.area / f.area.sum());
  return f;
}

// A vibration at one frequency: normal velocity, and surface pressure in phase with it and a quarter turn on.
struct Source {
  double k = 0;
  Eigen::VectorXd velocity, in_phase, out_of_phase;
};

// Sum of A e^(i k e.x) (rho c u + e.n p_s), its parts even and odd in e: towards e it is even + odd, towards
// -e even - odd.
struct Towards {
  std::complex<double> even, odd;
};
Towards towards(const Vec3& e, const Facets& f, const Source& source) {
  double even_re = 0, even_im = 0, odd_re = 0, odd_im = 0;
  for (Eigen::Index j = 0; j < source.velocity.size(); ++j) {
    const double phase = source.k * e.dot(f.middle.col(j)), facing = e.dot(f.normal.col(j)) * f.area[j];
    const double c = std::cos(phase), s = std::sin(phase),
                 flow = air_density * speed_of_sound * f.area[j] * source.velocity[j];
    // Of e: (c + i s)(flow + facing p); of -e: (c - i s)(flow - facing p).
    even_re += c * flow - s * facing * source.out_of_phase[j];
    even_im += s * facing * source.in_phase[j];
    odd_re += c * facing * source.in_phase[j];
    odd_im += s * flow + c * facing * source.out_of_phase[j];
  }
  return {{even_re, even_im}, {odd_re, odd_im}};
}

// Mean over all directions of the square.
double mean_square(const Facets& f, const Source& source) {
  const double reach = std::sqrt(f.middle.colwise().squaredNorm().maxCoeff());
  // Beams are as narrow as a wavelength over the body's size.
  const int directions = static_cast<int>(
      std::clamp(std::pow(0.5 * source.k * reach, 2), double(fewest_directions), double(most_directions)));
  double sum = 0;
  for (int d = 0; d < directions; ++d) {
    const Towards t = towards(direction(d, directions), f, source);
    sum += std::norm(t.even) + std::norm(t.odd);
  }
  return sum / directions;
}

// Of the air before a wave of wave number 1 / s on a surface as large as a sphere of radius s / `share`, over
// rho c; x = k s.
std::complex<double> wave_impedance(double x, double share) {
  return x / std::sqrt(std::complex<double>(x * x - 1, -2 * std::cbrt(share * share) * x));
}

Vec3 normal_times_area(const std::vector<Vec3>& points, const Triangle& t) {
  const Vec3& o = points[std::size_t(t[0])];
  return 0.5 * (points[std::size_t(t[1])] - o).cross(points[std::size_t(t[2])] - o);
}

// The sides of triangles that no other triangle goes back along.
std::vector<std::pair<int, int>> rim_of(const std::vector<Triangle>& triangles) {
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

// Without what is inside, and points of no triangle.
void keep_outside(ModalModel& model) {
  model.triangles = outside_of(model.points, model.triangles);
  std::vector<int> number(model.points.size(), -1);
  std::vector<Vec3> points;
  std::vector<float> shapes;
  const auto row = 3 * std::ptrdiff_t(model.modes());
  for (Triangle& t : model.triangles) {
    for (int& p : t) {
      int& n = number[std::size_t(p)];
      if (n < 0) {
        n = static_cast<int>(points.size());
        points.push_back(model.points[std::size_t(p)]);
        shapes.insert(shapes.end(), model.shapes.begin() + p * row, model.shapes.begin() + (p + 1) * row);
      }
      p = n;
    }
  }
  model.points = std::move(points);
  model.shapes = std::move(shapes);
}

// A sheet becomes both its sides, `thickness` apart, sewn along the rim; velocities are those of its points.
void double_sheet(ModalModel& model, double thickness) {
  const std::vector<std::pair<int, int>> rim = rim_of(model.triangles);
  std::vector<Vec3> normal(model.points.size(), Vec3::Zero());
  for (const Triangle& t : model.triangles) {
    for (const int p : t) normal[std::size_t(p)] += normal_times_area(model.points, t);
  }
  const std::size_t points = model.points.size(), triangles = model.triangles.size();
  for (std::size_t p = 0; p < points; ++p) {
    const Vec3 half = 0.5 * thickness * normal[p].stableNormalized();
    model.points.push_back(model.points[p] - half);
    model.points[p] += half;
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto [a, b, c] = model.triangles[t];
    const int back = static_cast<int>(points);
    model.triangles.push_back({a + back, c + back, b + back});
  }
  for (const auto& [a, b] : rim) {
    const int back = static_cast<int>(points);
    model.triangles.push_back({b, a, a + back});
    model.triangles.push_back({b, a + back, b + back});
  }
  const std::vector<float> one_side = model.shapes;
  model.shapes.insert(model.shapes.end(), one_side.begin(), one_side.end());
}

}  // namespace

std::vector<double> radiated_pressure(const VibratingSurface& surface, std::span<const double> omega,
                                      const Eigen::MatrixXd& kin) {
  const Eigen::MatrixXd potential = near_potential(surface.points, surface.triangles, surface.velocity);
  const Facets f = facets_of(surface);
  const double finest = finest_phase / std::sqrt(f.area.sum() / double(f.area.size()));
  const double reach = std::sqrt(f.area.sum() / (4 * std::numbers::pi));
  const double impedance = air_density * speed_of_sound;
  // <u, u> and <u, Phi> of each vibration and its kin: traces, which no rotation among them changes.
  const Eigen::VectorXd squares = (f.area.transpose() * surface.velocity.cwiseAbs2()).transpose();
  const Eigen::VectorXd products =
      (f.area.transpose() * surface.velocity.cwiseProduct(potential)).transpose();
  const Eigen::VectorXd kin_squares = kin * squares, kin_products = kin * products;
  Eigen::VectorXd mean(surface.velocity.cols()), heard(surface.velocity.cols());
  for (Eigen::Index m = 0; m < surface.velocity.cols(); ++m) {
    const double k = std::min(omega[std::size_t(m)] / speed_of_sound, finest);
    const double s = kin_squares[m] > 0 ? std::max(0.0, kin_products[m] / kin_squares[m]) : 0;
    const std::complex<double> z = wave_impedance(k * s, s / reach);
    const double out_of_phase = s > 0 ? z.imag() / (k * s) : 1;
    const Source source{k, surface.velocity.col(m), z.real() * impedance * surface.velocity.col(m),
                        out_of_phase * k * impedance * potential.col(m)};
    const double per_sum = k / (4 * std::numbers::pi);
    mean[m] = k * s > supersonic ? impedance * impedance * z.real() * squares[m] / (4 * std::numbers::pi)
                                 : per_sum * per_sum * mean_square(f, source);
    const Towards t = towards(listening_direction(), f, source);
    heard[m] = per_sum * ((t.even + t.odd).real() + (t.even + t.odd).imag());
  }
  const Eigen::VectorXd group_mean = kin * mean, group_heard = kin * heard.cwiseAbs2();
  std::vector<double> pressure;
  for (Eigen::Index m = 0; m < heard.size(); ++m) {
    // Nothing at all is heard from there of a body that moves only within its surface.
    pressure.push_back(group_heard[m] > 0 ? heard[m] * std::sqrt(group_mean[m] / group_heard[m])
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
  for (const Triangle& t : outside_of(model.points, model.triangles)) {
    const Vec3 n = normal_times_area(model.points, t) / 3;
    for (int m = 0; m < model.modes(); ++m) {
      for (const int p : t) sum[m] += n.dot(model.shape(p, m));
    }
  }
  return sum;
}

std::vector<double> radiation_of(const ModalModel& model, const Eigen::RowVectorXd& volume,
                                 double thickness) {
  ModalModel coarse = model;
  const bool is_sheet = thickness > 0 && !rim_of(model.triangles).empty();
  if (!is_sheet) keep_outside(coarse);
  SampleOptions sample;
  for (int round = 0; round < 5 && coarse.points.size() > most_points; ++round) {
    sample = {2 * sample.shape_error, 2 * sample.distance};
    sample_surface(coarse, sample);
  }
  if (is_sheet) double_sheet(coarse, thickness);
  coarse.triangles = outside_of(coarse.points, coarse.triangles);
  VibratingSurface surface{coarse.points, coarse.triangles,
                           Eigen::MatrixXd(Eigen::Index(coarse.triangles.size()), coarse.modes())};
  double area = 0;
  for (Eigen::Index j = 0; j < surface.velocity.rows(); ++j) {
    const Triangle& t = coarse.triangles[std::size_t(j)];
    const Vec3 n = normal_times_area(coarse.points, t);
    area += n.norm();
    for (int m = 0; m < coarse.modes(); ++m)
      surface.velocity(j, m) =
          n.normalized().dot(coarse.shape(t[0], m) + coarse.shape(t[1], m) + coarse.shape(t[2], m)) / 3;
  }
  if (!is_sheet) surface.velocity.rowwise() += ((volume - volume_velocity(coarse)) / area).eval();
  coarse.radiation =
      radiated_pressure(surface, model.angular_frequency, kinship(model.angular_frequency, model.damping));
  limit_radiation(coarse);
  return coarse.radiation;
}

}  // namespace intaglio::sound
