// Every case of closed-form and Ritz frequencies that is known: solid spheres (Lamb's equation), and cube,
// plates and bar by a Legendre-basis Ritz computation that is independent of any mesh; the free thin square
// plate is NAFEMS FV12, with modes 10 to 12 as thin-plate theory has them, since NAFEMS's own 4.233 and 7.416
// Hz lie above an upper bound of the exact ones (test_thin_plate.cpp). Three of the cube's groups are exact
// Lame modes or equal by coincidence, not by symmetry: the mesh splits them. Prints a table:
//   build/release/tests/test_bake -tc='*known frequencies*' -s
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <cmath>

#include "sound/bake/fem/modes.h"
#include "sound/bake/fem/tet_mesh.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

struct Group {
  double value;  // Hz, or eta of a sphere
  int count = 1;
};

struct Case {
  const char* name;
  TetMesh mesh;
  Material material;
  std::vector<Group> groups;
  double tolerance;
  double unit = 1;  // Hz of a value of 1
};

Material like_steel(double poisson, double density = 7850, double youngs_modulus = 200e9) {
  Material material = test::steel();
  material.poisson_ratio = poisson;
  material.density = density;
  material.youngs_modulus = youngs_modulus;
  return material;
}

// f = eta c_s / (2 pi a), of a sphere of radius 0.3 m.
Case sphere(const char* name, double poisson, std::vector<Group> eta, int level) {
  const Material material = like_steel(poisson);
  return {name,     ball(0.3, level),
          material, std::move(eta),
          0.003,    std::sqrt(material.shear_modulus() / material.density) / (tau * 0.3)};
}

std::vector<Case> cases() {
  const std::vector<Group> third{{2.50113, 5}, {2.64622, 5}, {3.52999, 3}, {3.86470, 7},
                                 {3.93740, 7}, {4.99551},    {5.00696, 5}};
  const std::vector<Group> quarter{{2.50113, 5}, {2.63987, 5}, {3.42453, 3}};
  std::vector<Case> all;
  all.push_back(sphere("sphere, nu 0.30", 0.30, third, 3));
  all.push_back(sphere("sphere, nu 0.25", 0.25, quarter, 2));
  all.push_back({"cube 1 m",
                 box({1, 1, 1}, 10, 10, 10),
                 test::steel(),
                 {{1422.93, 2},
                  {1916.11, 3},
                  {1948.64, 3},
                  {2213.49, 3},
                  {2278.22, 3},
                  {2387.75, 3},
                  {2703.13, 2},
                  {2745.80, 3}},
                 0.003});
  all.push_back({"plate 1 x 1 x 0.02 m",
                 box({1, 0.02, 1}, 32, 1, 32),
                 test::steel(),
                 {{64.942}, {95.136}, {117.784}, {167.689, 2}, {295.665, 2}, {305.703}, {333.170}},
                 0.005});
  all.push_back({"ceramic tile 0.3 x 0.3 x 0.01 m",
                 box({0.3, 0.01, 0.3}, 30, 1, 30),
                 *find_material("ceramic"),
                 {{381.30}, {554.54}, {633.01}, {962.83, 2}, {1631.92, 2}, {1742.00}},
                 0.005});
  all.push_back({"bar 1 x 0.1 x 0.05 m",
                 box({1, 0.1, 0.05}, 24, 6, 4),
                 test::steel(),
                 {{257.19}, {501.40}, {698.11}, {1160.15}, {1305.99}, {1339.39}, {2155.01}, {2323.97}},
                 0.003});
  all.push_back({"thin plate 10 x 10 x 0.05 m (FV12)",
                 box({10, 0.05, 10}, 28, 1, 28),
                 like_steel(0.3, 8000),
                 {{1.622}, {2.360}, {2.922}, {4.190, 2}, {7.356}},
                 0.005});
  return all;
}

}  // namespace

TEST_CASE("known frequencies: each case of the reference, its degenerate groups whole and unsplit" *
          doctest::test_suite("statistics")) {
  for (const Case& c : cases()) {
    INFO(std::string(c.name));
    int count = 0;
    for (const Group& g : c.groups) count += g.count;
    // One more shows where the last group ends.
    const double highest = 1.2 * c.groups.back().value * c.unit;
    const auto modes = free_modes(assemble(c.mesh, c.material), {count, 0.2, highest});
    if (!modes) MESSAGE(modes.error().message());
    REQUIRE(modes);
    REQUIRE(modes->angular_frequency.size() >= count);
    double worst = 0, split = 0;
    Eigen::Index i = 0;
    for (const Group& g : c.groups) {
      const auto group = (modes->angular_frequency.segment(i, g.count) / (tau * c.unit)).eval();
      CAPTURE(g.value);
      worst = std::max(worst, (group.array() / g.value - 1).abs().maxCoeff());
      split = std::max(split, group.maxCoeff() / group.minCoeff() - 1);
      i += g.count;
    }
    const double rigid = modes->highest_rigid / modes->angular_frequency[0];
    MESSAGE(fmt::format("{:36} {:6} elements: worst {:.3f} %, split {:.4f} %, rigid {:.1e} of the first",
                        c.name, c.mesh.tets.size(), 100 * worst, 100 * split, rigid));
    CHECK(worst < c.tolerance);
    CHECK(split < 0.0005);
    CHECK(rigid < 0.01);
  }
}
