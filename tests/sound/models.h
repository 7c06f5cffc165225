// Small bodies for tests of sound: baked once, and one made by hand whose modes are known exactly.
#pragma once

#include <memory>
#include <numbers>

#include "core/portable_math.h"
#include "sound/bake/bake.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/bake/radiation.h"
#include "sound/modal_bank.h"
#include "sound/modal_model.h"

namespace intaglio::sound::test {

inline constexpr double tau = 2 * std::numbers::pi;

inline Material steel() {
  Material material;
  material.name = "test steel";
  material.density = 7850;
  material.youngs_modulus = 200e9;
  material.poisson_ratio = 0.3;
  material.rayleigh_alpha = 5;
  material.rayleigh_beta = 3e-8;
  return material;
}

// A hard little ball, 20 mm, of the given material.
inline std::shared_ptr<const ModalModel> small_ball() {
  static const auto model = std::make_shared<const ModalModel>(
      bake(ball(0.02, 1), *find_material("plastic"), {"ball", {20, 20, 30'000}}).value());
  return model;
}

// A slab, 0.5 x 0.03 x 0.5 m of brick.
inline std::shared_ptr<const ModalModel> small_slab() {
  static const auto model = std::make_shared<const ModalModel>(
      bake(box({0.5, 0.03, 0.5}, 6, 1, 6), *find_material("brick"), {"slab", {40, 20, 20'000}}).value());
  return model;
}

// One triangle that moves along z as a whole in every mode: gains are the z of the direction.
inline ModalModel model_of(std::vector<double> hertz, std::vector<double> damping) {
  ModalModel model;
  model.mass = 1;
  model.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  model.triangles = {{0, 1, 2}};
  model.grid = TriangleGrid(model.points, model.triangles);
  model.damping = std::move(damping);
  for (const double f : hertz) model.angular_frequency.push_back(tau * f);
  model.radiation.assign(hertz.size(), 1.0);
  for (int point = 0; point < 3; ++point) {
    model.shapes.insert(model.shapes.end(), 2 * hertz.size(), 0.0f);
    model.shapes.insert(model.shapes.end(), hertz.size(), 1.0f);
  }
  return model;
}

inline constexpr double rate = 44'100;

// What a unit impulse of `direction` at a point of the model gives, until it has died away.
inline std::vector<float> struck_at(const ModalModel& model, const Vec3& point, const Vec3& direction,
                                    std::size_t samples) {
  ModalBank bank(model, rate);
  std::vector<float> gains(std::size_t(bank.padded_modes()), 0.0f), out(samples, 0.0f);
  model.gains(point, direction, std::span(gains).first(std::size_t(bank.modes())));
  const float blow = 1;
  const std::array<Drive, 1> drive{{{gains, std::span(&blow, 1), 0}}};
  for (std::size_t done = 0; done < samples; done += block_samples)
    bank.process(done == 0 ? std::span<const Drive>(drive) : std::span<const Drive>(),
                 std::span(out).subspan(done, std::min<std::size_t>(block_samples, samples - done)));
  return out;
}

inline std::vector<float> struck(const ModalModel& model, int point, const Vec3& direction,
                                 std::size_t samples) {
  return struck_at(model, model.points[std::size_t(point)], direction, samples);
}

inline Vec3 any_direction(Random& random) {
  Vec3 d;
  do {
    for (int axis = 0; axis < 3; ++axis)
      d[axis] = random.uniform(-1, 1);  // in this order, whatever the compiler
  } while (!(d.norm() > 0.1 && d.norm() < 1));
  return d.normalized();
}

// What each mode radiates together with those that sound as one with it, Pa^2 at 1 m.
inline Eigen::VectorXd radiated_power(const ModalModel& model, const std::vector<double>& radiation) {
  const Eigen::Map<const Eigen::VectorXd> pressure(radiation.data(), model.modes());
  return kinship(model.angular_frequency, model.damping) * pressure.cwiseAbs2();
}

}  // namespace intaglio::sound::test
