// Small bodies for tests of sound: baked once, and one made by hand whose modes are known exactly.
#pragma once

#include <memory>
#include <numbers>

#include "intaglio/sound/fem/shapes.h"
#include "intaglio/sound/modal_model.h"

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

}  // namespace intaglio::sound::test
