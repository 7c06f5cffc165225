#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <set>

#include "sound/bake/fem/elastic_system.h"
#include "sound/bake/fem/tet_mesh.h"
#include "tests/sound/models.h"

using namespace intaglio;
using namespace intaglio::sound;

namespace {

struct Named {
  const char* name;
  TetMesh mesh;
  double volume;
  double tolerance;  // relative: faces are quadratic, not round
};

std::vector<Named> all_shapes() {
  const double pi = std::numbers::pi;
  return {{"ball 0", ball(0.5, 0), pi / 6, 0.08},
          {"ball 1", ball(0.5, 1), pi / 6, 8e-3},
          {"ball 2", ball(0.5, 2), pi / 6, 6e-4},
          {"box", box({1, 2, 3}, 2, 3, 4), 6, 1e-12},
          {"thin box", box({1, 0.02, 1}, 5, 1, 5), 0.02, 1e-12},
          {"cylinder 1", cylinder(0.1, 1, 1, 3), pi * 0.01, 8e-3},
          {"cylinder 2", cylinder(0.1, 1, 2, 5), pi * 0.01, 6e-4},
          {"cylinder 4", cylinder(0.1, 1, 4, 2), pi * 0.01, 5e-5}};
}

}  // namespace

TEST_CASE("shapes have the volume of their closed form and positive elements everywhere") {
  for (const Named& shape : all_shapes()) {
    CAPTURE(shape.name);
    CHECK(volume(shape.mesh) == doctest::Approx(shape.volume).epsilon(shape.tolerance));
    double least = 1, most = 0;
    for (const Tet10& tet : shape.mesh.tets) {
      const ElementNodes nodes = element_nodes(shape.mesh, tet);
      for (const QuadraturePoint& q : tet_quadrature()) {
        least = std::min(least, jacobian(nodes, q.barycentric) / (6 * element_volume(nodes)));
        most = std::max(most, jacobian(nodes, q.barycentric) / (6 * element_volume(nodes)));
      }
      for (std::size_t corner = 0; corner < 4; ++corner) {
        std::array<double, 4> at{};
        at[corner] = 1;
        CHECK(jacobian(nodes, at) > 0);
      }
    }
    CHECK(least > 0.3);
    CHECK(most < 2);
  }
}

TEST_CASE("the boundary is closed, faces outward, and encloses the volume") {
  for (const Named& shape : all_shapes()) {
    CAPTURE(shape.name);
    std::map<std::pair<int, int>, int> edges;
    double enclosed = 0;
    for (const Triangle6& face : shape.mesh.boundary) {
      for (std::size_t i = 0; i < 3; ++i) ++edges[{face[i], face[(i + 1) % 3]}];
      const auto node = [&](std::size_t i) { return shape.mesh.nodes[std::size_t(face[i])]; };
      enclosed += node(0).dot(node(1).cross(node(2))) / 6;
      for (std::size_t i = 0; i < 3; ++i) {
        CHECK((node(3 + i) - 0.5 * (node(i) + node((i + 1) % 3))).norm() <
              0.3 * (node(i) - node((i + 1) % 3)).norm());
      }
    }
    bool is_closed = true;
    for (const auto& [edge, count] : edges)
      is_closed &= count == 1 && edges.count({edge.second, edge.first}) == 1;
    CHECK(is_closed);
    CHECK(enclosed > 0.4 * shape.volume);
    CHECK(enclosed < (1 + 1e-12) * shape.volume);
  }
}

TEST_CASE("every node is used, centred, and, if on the boundary, on the surface") {
  for (const Named& shape : all_shapes()) {
    CAPTURE(shape.name);
    std::set<int> used;
    for (const Tet10& tet : shape.mesh.tets) used.insert(tet.begin(), tet.end());
    CHECK(used.size() == shape.mesh.nodes.size());
    Vec3 centre = Vec3::Zero();
    for (const Vec3& node : shape.mesh.nodes) centre += node / double(shape.mesh.nodes.size());
    CHECK(centre.norm() < 1e-12);
  }
  const TetMesh round = ball(0.5, 1);
  for (const Triangle6& face : round.boundary) {
    for (const int node : face) CHECK(round.nodes[std::size_t(node)].norm() == doctest::Approx(0.5));
  }
}

TEST_CASE("assembled: mass is rho V in each direction, rigid motions are free") {
  for (const Named& shape : all_shapes()) {
    CAPTURE(shape.name);
    const ElasticSystem system = assemble(shape.mesh, test::steel());
    const auto n = Eigen::Index(shape.mesh.nodes.size());
    const double scale = system.stiffness.norm();
    CHECK((system.mass - SparseMatrix(system.mass.transpose())).norm() < 1e-15 * system.mass.norm());
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::VectorXd shift = Eigen::VectorXd::Zero(3 * n), spin = shift;
      for (Eigen::Index a = 0; a < n; ++a) {
        shift[3 * a + axis] = 1;
        spin.segment<3>(3 * a) = Vec3::Unit(axis).cross(shape.mesh.nodes[std::size_t(a)]);
      }
      CHECK(shift.dot(system.mass_times(shift).col(0)) == doctest::Approx(7850 * volume(shape.mesh)));
      CHECK(system.stiffness_times(shift).norm() < 1e-12 * scale);
      CHECK(system.stiffness_times(spin).norm() < 1e-12 * scale);
    }
  }
}
