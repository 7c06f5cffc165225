#include "sound/modal_model.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace intaglio::sound {

namespace {

// As a fraction of the decay rate: slower beats die away before they are heard.
constexpr double slow_beat = 0.01;

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

Eigen::MatrixXd kinship(std::span<const double> omega, std::span<const double> damping) {
  const auto count = Eigen::Index(omega.size());
  Eigen::MatrixXd kin(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b < count; ++b) {
      const auto i = std::size_t(a), k = std::size_t(b);
      // At least the width of a group that a bake takes for one frequency.
      const double width = slow_beat * 0.5 * (damping[i] + damping[k]) + 5e-6 * (omega[i] + omega[k]);
      kin(a, b) = std::exp(-std::pow((omega[i] - omega[k]) / width, 4));
    }
  }
  return kin;
}

double most_radiated(double damping) {
  return std::sqrt(air_density * speed_of_sound * damping / (2 * std::numbers::pi));
}

std::vector<double> radiated_share(const ModalModel& model) {
  const auto count = Eigen::Index(model.modes());
  const Eigen::MatrixXd kin = kinship(model.angular_frequency, model.damping);
  Eigen::VectorXd power(count), most(count);
  for (Eigen::Index m = 0; m < count; ++m) {
    power[m] = std::pow(model.radiation[std::size_t(m)], 2);
    most[m] = std::pow(most_radiated(model.damping[std::size_t(m)]), 2);
  }
  const Eigen::VectorXd is = kin * power, may_be = kin * most;
  std::vector<double> share;
  for (Eigen::Index m = 0; m < count; ++m)
    share.push_back(is[m] > 0 ? std::sqrt(is[m] / std::max(may_be[m], 1e-300)) : 0);
  return share;
}

void limit_radiation(ModalModel& model, std::span<const double> before) {
  const std::vector<double> share = radiated_share(model);
  for (std::size_t m = 0; m < share.size(); ++m) {
    const double limit = before.empty() ? 1.0 : std::max(1.0, before[m]);
    if (share[m] > limit) model.radiation[m] *= limit / share[m];
  }
}

ModalModel scaled(const ModalModel& model, double scale) {
  assert(scale > 0);
  ModalModel out;
  out.name = model.name;
  out.material = model.material;
  out.mass = model.mass * scale * scale * scale;
  out.area = model.area * scale * scale;
  out.residual = model.residual;
  out.modes_found = model.modes_found;
  out.merge_error_db = model.merge_error_db;
  out.merge_error_rms_db = model.merge_error_rms_db;
  out.triangles = model.triangles;
  for (const Vec3& point : model.points) out.points.push_back(scale * point);
  out.grid = TriangleGrid(out.points, out.triangles);

  const double shape_scale = 1 / (scale * std::sqrt(scale));
  std::vector<std::size_t> kept;
  for (std::size_t m = 0; m < model.angular_frequency.size(); ++m) {
    const double omega = model.angular_frequency[m] / scale;
    const double d = 0.5 * (model.material.rayleigh_alpha + model.material.rayleigh_beta * omega * omega);
    if (d >= omega) continue;
    kept.push_back(m);
    out.angular_frequency.push_back(omega);
    out.damping.push_back(d);
    // Wavelengths grow as the body does, so only how far and how fast its surface moves is another.
    out.radiation.push_back(model.radiation[m] * scale * shape_scale);
  }
  // A mode that was merged from several had the allowance of all of them.
  const std::vector<double> share = radiated_share(model);
  std::vector<double> before;
  for (const std::size_t m : kept) before.push_back(share[m]);
  limit_radiation(out, before);
  const std::size_t modes = model.angular_frequency.size();
  for (std::size_t row = 0; row < 3 * model.points.size(); ++row) {
    for (const std::size_t m : kept)
      out.shapes.push_back(static_cast<float>(shape_scale) * model.shapes[row * modes + m]);
  }
  return out;
}

}  // namespace intaglio::sound
