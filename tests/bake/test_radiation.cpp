// Radiation of vibrating surfaces, against closed forms.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <complex>
#include <functional>

#include "core/portable_math.h"
#include "sound/bake/bake.h"
#include "sound/bake/near_field.h"
#include "sound/bake/radiation.h"
#include "sound/impact.h"
#include "sound/modal_model.h"
#include "sound/strike.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

constexpr double rho_c = air_density * speed_of_sound;

// The boundary of a mesh, each face of an element as one triangle: no finer than needed here.
VibratingSurface surface_of(const TetMesh& mesh, const std::function<Vec3(const Vec3&)>& velocity) {
  ModalSurface fine = boundary_surface(mesh);
  VibratingSurface s{fine.points, fine.triangles, Eigen::MatrixXd(Eigen::Index(fine.triangles.size()), 1)};
  for (std::size_t j = 0; j < s.triangles.size(); ++j) {
    const Vec3 &a = s.points[std::size_t(s.triangles[j][0])], &b = s.points[std::size_t(s.triangles[j][1])],
               &c = s.points[std::size_t(s.triangles[j][2])];
    s.velocity(Eigen::Index(j), 0) = velocity((a + b + c) / 3).dot((b - a).cross(c - a).normalized());
  }
  return s;
}

// At each of these wave numbers, Pa at 1 m.
std::vector<double> pressures(VibratingSurface s, const std::vector<double>& wave_numbers) {
  std::vector<double> omega;
  for (const double k : wave_numbers) omega.push_back(k * speed_of_sound);
  s.velocity = s.velocity.col(0).replicate(1, Eigen::Index(omega.size())).eval();
  return radiated_pressure(s, omega);
}

double legendre(int n, double x) {
  return std::legendre(unsigned(n), x);
}

// A sphere whose surface moves outward with P_n(cos angle): rho c / (k |h_n'(ka)| sqrt(2n + 1)) at 1 m.
double of_sphere(int n, double k, double radius) {
  const double x = k * radius;
  const auto h = [&](int order) {
    return order < 0 ? std::complex<double>(std::cos(x) / x, std::sin(x) / x)
                     : std::complex<double>(std::sph_bessel(unsigned(order), x),
                                            std::sph_neumann(unsigned(order), x));
  };
  const std::complex<double> slope = h(n - 1) - (n + 1) / x * h(n);
  return rho_c / (k * std::abs(slope) * std::sqrt(2.0 * n + 1));
}

double decibels(double ratio) {
  return 20 * std::log10(ratio);
}

}  // namespace

TEST_CASE("the potentials of a triangle are those of many points on it") {
  Random random(5);
  const auto vec = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 a = vec(), b = vec(), c = vec(), x = 1.5 * vec();
    const Vec3 cross = 0.5 * (b - a).cross(c - a);
    double single_layer = 0, double_layer = 0;
    const int cells = 400;
    for (int i = 0; i < cells; ++i) {
      for (int j = 0; j < cells - i; ++j) {
        for (const double shift : {1.0 / 3, 2.0 / 3}) {
          if (shift > 0.5 && j == cells - i - 1) continue;
          const Vec3 y = a + (i + shift) / cells * (b - a) + (j + shift) / cells * (c - a), way = x - y;
          single_layer += cross.norm() / (cells * cells) / way.norm();
          double_layer += cross.dot(way) / (cells * cells) / std::pow(way.norm(), 3);
        }
      }
    }
    const TrianglePotential p = triangle_potential(x, a, b, c);
    CHECK(p.single_layer == doctest::Approx(single_layer).epsilon(1e-3));
    CHECK(p.double_layer == doctest::Approx(double_layer).epsilon(2e-2));
  }
}

TEST_CASE("the orders of a sphere, from pulsation up, radiate as in closed form" *
          doctest::test_suite("statistics")) {
  const double a = 0.1;
  // The mesh, not quite round, mixes orders with lower ones: they are compared from 30 dB below these up.
  const std::array<double, 4> from{0.02, 0.05, 0.1, 2}, worst{0.2, 1.2, 1.2, 1.6};
  for (int n = 0; n < 4; ++n) {
    CAPTURE(n);
    const VibratingSurface sphere = surface_of(
        ball(a, 2), [&](const Vec3& x) { return Vec3(legendre(n, x.normalized().y()) * x.normalized()); });
    const Eigen::MatrixXd phi = incompressible_potential(sphere.points, sphere.triangles, sphere.velocity);
    const double s = phi.col(0).dot(sphere.velocity.col(0)) / sphere.velocity.col(0).squaredNorm();
    CHECK(s == doctest::Approx(a / (n + 1)).epsilon(0.03));
    std::vector<double> k;
    for (double ka = from[std::size_t(n)]; ka < 60; ka *= 1.3) k.push_back(ka / a);
    const std::vector<double> p = pressures(sphere, k);
    double most = 0;
    for (std::size_t i = 0; i < k.size(); ++i)
      most = std::max(most, std::abs(decibels(p[i] / of_sphere(n, k[i], a))));
    MESSAGE("order " << n << ": " << most << " dB off at most, " << decibels(p[0] / of_sphere(n, k[0], a))
                     << " at ka " << k[0] * a);
    CHECK(most < worst[std::size_t(n)]);
  }
}

TEST_CASE("a disk that oscillates along its axis is a dipole of known moment, however thin" *
          doctest::test_suite("statistics")) {
  const double a = 0.1, k = 0.2 / a;
  for (const double t : {0.03, 0.003, 0.0003}) {
    const VibratingSurface disk = surface_of(cylinder(a, t, 6, 1), [](const Vec3&) { return Vec3(0, 1, 0); });
    // 8/3 rho a^3 of air moves along, and the volume of the disk itself (thick ones move some more air).
    const double moment = 8.0 / 3 * a * a * a + tau / 2 * a * a * t;
    const double exact = rho_c * k * k * moment / (2 * tau) / std::sqrt(3.0);
    const double off = decibels(pressures(disk, {k})[0] / exact);
    MESSAGE("thickness " << t << ": " << off << " dB");
    CHECK(std::abs(off) < 1.2);
  }
}

TEST_CASE(
    "below k L = 1 the twist of a square plate falls by 24 dB per octave, its oscillation by 12, its pulsation by 6" *
    doctest::test_suite("statistics")) {
  const TetMesh plate = box({0.3, 0.01, 0.3}, 10, 1, 10);
  const auto slope = [&](const std::function<Vec3(const Vec3&)>& velocity) {
    const std::vector<double> p = pressures(surface_of(plate, velocity), {0.6, 1.2});
    return decibels(p[1] / p[0]);
  };
  CHECK(slope([](const Vec3& x) { return Vec3(0, x.x() * x.z(), 0); }) ==
        doctest::Approx(24.1).epsilon(0.03));
  CHECK(slope([](const Vec3&) { return Vec3(0, 1, 0); }) == doctest::Approx(12.0).epsilon(0.03));
  CHECK(slope([](const Vec3& x) { return Vec3(0, x.y() > 0 ? 1 : -1, 0); }) ==
        doctest::Approx(6.0).epsilon(0.03));
}

TEST_CASE("above coincidence a bending plate radiates as a piston does: rho c u over its faces" *
          doctest::test_suite("statistics")) {
  const TetMesh plate = box({0.4, 0.01, 0.4}, 12, 1, 12);
  const double q = 3 * tau / 0.4, k = 3 * q;  // sound is three times slower than the bending wave
  const VibratingSurface bent =
      surface_of(plate, [&](const Vec3& x) { return Vec3(0, std::cos(q * x.x()) * std::cos(q * x.z()), 0); });
  // Mean square of both faces, at the angle at which the wave leaves: power rho c A u^2 / cos over the
  // sphere.
  const auto off = [&](double wave_number) {
    const double cosine = std::sqrt(1 - 2 * q * q / (wave_number * wave_number));
    const double exact = rho_c * std::sqrt(2 * 0.4 * 0.4 / 4 / (2 * tau) / cosine);
    return decibels(pressures(bent, {wave_number})[0] / exact);
  };
  MESSAGE("above coincidence " << off(k) << " dB, near it " << off(2 * q));
  CHECK(std::abs(off(k)) < 0.5);
  CHECK(std::abs(off(2 * q)) < 2);
  CHECK(std::abs(off(1.2 * std::sqrt(2) * q)) < 2);
  const double exact = rho_c * std::sqrt(2 * 0.4 * 0.4 / 4 / (2 * tau));
  // Below it, the little that is radiated comes from corners and edges.
  CHECK(decibels(pressures(bent, {q / 3})[0] / exact) < -15);
}

TEST_CASE("a baked body is louder the more volume it moves; a cavity and the scale do not matter") {
  const auto model = test::small_slab();
  REQUIRE(model->radiation.size() == std::size_t(model->modes()));
  // The slab's first mode is a twist, and quieter than the third, a ring.
  CHECK(decibels(std::abs(model->radiation[0] / model->radiation[2])) < -20);
  ModalModel hollow = *model;
  const int points = int(model->points.size());
  for (const Vec3& p : model->points) hollow.points.push_back(0.2 * p);
  for (const auto& [a, b, c] : model->triangles)
    hollow.triangles.push_back({a + points, c + points, b + points});
  hollow.shapes.insert(hollow.shapes.end(), model->shapes.begin(), model->shapes.end());
  const std::vector<double> radiation = mode_radiation(hollow, volume_velocity(hollow));
  const std::vector<double> without = mode_radiation(*model, volume_velocity(*model));
  for (std::size_t m = 0; m < radiation.size(); ++m) CHECK(radiation[m] == without[m]);
}

TEST_CASE("an open shell given as one sheet radiates from both sides, as the plate of its thickness does") {
  const double thickness = 0.008;
  ModalModel model =
      bake(box({0.3, thickness, 0.3}, 8, 1, 8), test::steel(), {"plate", {8, 20, 20'000}, {0}}).value();
  const std::vector<double> solid = model.radiation;
  const auto is_below = [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(),
                       [&](int p) { return model.points[std::size_t(p)].y() < 0.49 * thickness; });
  };
  std::erase_if(model.triangles, is_below);
  for (Vec3& p : model.points) p.y() = 0;
  const std::vector<double> sheet = mode_radiation(model, volume_velocity(model), thickness);
  const Eigen::VectorXd of_solid = test::radiated_power(model, solid),
                        of_sheet = test::radiated_power(model, sheet);
  for (Eigen::Index m = 0; m < model.modes(); ++m) {
    CAPTURE(m);
    // In-plane motion radiates from the edges, which a sheet does not have.
    if (of_solid[m] > 0.01) CHECK(std::abs(10 * std::log10(of_sheet[m] / of_solid[m])) < 2);
  }
}

TEST_CASE("a struck slab is as loud as an infinite plate: rho F / (2 pi m) at 1 m") {
  // Force F on a plate of m kg/m^2, with negligible air load. Source: Cremer, Heckl, Petersson, §6.
  const auto model = test::small_slab();
  Strike strike;
  strike.mallet = {*find_material("steel"), 0.02};
  strike.at = Vec3(0.07, 0.015, 0.03);
  Synthesizer synthesizer({}, strike_bodies(model, strike));
  const ContactEvent blow = strike_event(*model, strike, 0.01);
  synthesizer.push(blow);
  std::vector<float> audio(4410);
  synthesizer.render(audio);
  float peak = 0;
  for (const float x : audio) peak = std::max(peak, std::abs(x));
  const double mass = 1 / (1 / strike.mallet.mass() + 1 / model->mass), impulse = blow.impulse.norm();
  const double duration = hertz_contact_duration(
      mass, strike.mallet.radius, effective_modulus(strike.mallet.material, model->material), 1);
  const double force = tau / 4 * impulse / duration;
  const double expected = air_density * force / (tau * model->mass / 0.25);
  MESSAGE("peak " << peak << " Pa at 1 m, " << decibels(peak / expected)
                  << " dB of the plate without end; force " << force << " N for " << 1e3 * duration << " ms");
  CHECK(std::abs(decibels(peak / expected)) < 6);
}
