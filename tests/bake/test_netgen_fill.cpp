// Laws of filling by another program: whatever it does, one error or a mesh that fills the body; and if
// Netgen is installed, known frequencies. Programs that misbehave are shell scripts.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/file.h"
#include "core/process.h"
#include "sound/bake/fem/mesher.h"
#include "sound/bake/fem/modes.h"
#include "sound/bake/fem/tet_mesh.h"
#include "tests/bake/surfaces.h"
#include "tests/skipped.h"
#include "tests/sound/models.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::tau;

namespace {

namespace fs = std::filesystem;

// A program of its own folder that runs `commands`.
struct Script {
  tests::TemporaryFolder folder;
  fs::path path = folder.path / "filler";
  explicit Script(const std::string& commands) {
    REQUIRE(write_file(path, "#!/bin/sh\n" + commands + "\n"));
    fs::permissions(path, fs::perms::owner_all);
  }
};

// A bar whose cross-section is a pentagon: no lattice lies along its sides.
BodySurface pentagon() {
  std::vector<Vec3> points;
  std::vector<surface::Triangle> faces;
  for (int k = 0; k < 5; ++k) {
    const double a = tau * k / 5;
    points.emplace_back(0.03 * std::cos(a), 0, 0.03 * std::sin(a));
    points.emplace_back(0.03 * std::cos(a), 0.2, 0.03 * std::sin(a));
  }
  for (int k = 0; k < 5; ++k) {
    const int a = 2 * k, b = 2 * ((k + 1) % 5);
    faces.push_back({a, a + 1, b + 1});
    faces.push_back({a, b + 1, b});
    if (k > 0 && k < 4) {
      faces.push_back({0, a, b});
      faces.push_back({1, b + 1, a + 1});
    }
  }
  return body_surface(test::mesh_of(points, faces), "pentagon").value();
}

Eigen::VectorXd mode_frequencies(const TetMesh& mesh, int count) {
  return free_modes(assemble(mesh, test::steel()), {count, 20, 1e5}).value().angular_frequency / tau;
}

}  // namespace

TEST_CASE(
    "a mesher that hangs, crashes, fails or returns garbage is one error, and the lattice fills instead") {
  const struct {
    const char *commands, *says;
  } all[]{
      {"sleep 30", "took more than"},
      {"kill -SEGV $$", "crashed"},
      {"exit 3", "ended with code 3"},
      {"true", "returned nothing"},
      {"head -c 5000 /dev/urandom > $2", "unreadable mesh"},
      {": > $2", "returned nothing"},
      {"printf 'intaglio-tetrahedra 1\\n99999999999 1\\n' > $2", "unreadable mesh"},
      {"printf 'intaglio-tetrahedra 1\\n4 1\\n0 0 0 1 0 0 0 1 0 0 0 nan\\n0 1 2 3\\n' > $2",
       "unreadable mesh"},
      {"printf 'intaglio-tetrahedra 1\\n4 1\\n0 0 0 1 0 0 0 1 0 0 0 1\\n0 1 2 7\\n' > $2", "unreadable mesh"},
      {"printf 'intaglio-tetrahedra 1\\n4 1\\n0 0 0 1 0 0 0 1 0 0 0 1\\n0 1 2 3\\n' > $2", "do not fill"},
      {"printf 'intaglio-tetrahedra 1\\n4 1\\n0 0 0 1 0 0 0 1 0 1 1 0\\n0 1 2 3\\n' > $2", "do not fill"},
  };
  const BodySurface body = pentagon();
  for (const auto& misbehaviour : all) {
    INFO(std::string(misbehaviour.commands));
    const Script script(misbehaviour.commands);
    const NetgenOptions netgen{script.path, 0.5, 1000};
    const auto filled = fill_with(Mesher::netgen, body, {0.02, 2000}, netgen, "bar.obj");
    REQUIRE_FALSE(filled);
    const std::string message = filled.error().message();
    CHECK(message.starts_with("bar.obj"));
    CHECK(message.find(misbehaviour.says) != std::string::npos);
    CHECK(message.find('\n') == std::string::npos);
    const auto instead = fill_with(Mesher::automatic, body, {0.02, 2000}, netgen, "bar.obj");
    REQUIRE(instead);
    REQUIRE_FALSE(instead->notes.empty());
    CHECK(instead->notes.back().find("Netgen failed") != std::string::npos);
    CHECK(volume(instead->mesh) == doctest::Approx(body.volume).epsilon(0.05));
  }
}

TEST_CASE("intaglio-netgen refuses a request that declares more than it has") {
  if (find_netgen().empty()) {
    tests::skipped("no intaglio-netgen here (script/setup netgen, then build)");
    return;
  }
  const tests::TemporaryFolder folder;
  for (const std::string counts : {"999999999999999999 1", "-1 1", "3 999999999999999999", "3 1"}) {
    CAPTURE(counts);
    REQUIRE(
        write_file(folder.path / "request", "intaglio-netgen 1\n0.1 " + counts + "\n0 0 0 1 0 0 0 1 0\n"));
    const auto run = run_limited(find_netgen(), {"request", "result"}, folder.path, {5, 1000});
    REQUIRE_FALSE(run);
    CHECK(run.error().message().find("ended with code 2") != std::string::npos);
  }
}

TEST_CASE("without Netgen the error names the package, and automatic goes by the lattice and says so") {
  const char* before = std::getenv("INTAGLIO_NETGEN");
  const std::string kept = before ? before : "";
  setenv("INTAGLIO_NETGEN", "/not/there", 1);
  CHECK(find_netgen().empty());
  const auto filled = fill_with(Mesher::netgen, pentagon(), {0.02, 2000}, {}, "bar.obj");
  REQUIRE_FALSE(filled);
  CHECK(filled.error().message().find("libnglib-dev") != std::string::npos);
  const auto instead = fill_with(Mesher::automatic, pentagon(), {0.02, 2000}, {}, "bar.obj");
  REQUIRE(instead);
  CHECK(instead->notes.back().find("script/setup netgen") != std::string::npos);
  if (before) setenv("INTAGLIO_NETGEN", kept.c_str(), 1);
  if (!before) unsetenv("INTAGLIO_NETGEN");
}

TEST_CASE("automatic chooses Netgen only for bodies whose edges the lattice would cut off") {
  CHECK(has_skew_edges(pentagon(), 0.02));
  CHECK_FALSE(has_skew_edges(pentagon(), 0.1));  // finer than an element
  CHECK_FALSE(has_skew_edges(body_surface(test::icosphere(0.1, 3), "ball").value(), 0.02));
  CHECK_FALSE(has_skew_edges(body_surface(test::cuboid({0.3, 0.1, 0.2}), "box").value(), 0.02));
  auto askew = test::cuboid({0.3, 0.1, 0.2});
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& p : askew.positions) p = turn * p;
  CHECK_FALSE(has_skew_edges(body_surface(askew, "box").value(), 0.02));  // the lattice is rotated with it
}

TEST_CASE("Netgen's elements have known frequencies, and its limits hold") {
  if (find_netgen().empty()) {
    tests::skipped("no intaglio-netgen here (script/setup netgen, then build)");
    return;
  }
  auto askew = test::cuboid({0.3, 0.05, 0.04});
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& p : askew.positions) p = turn * p;
  const auto bar = netgen_fill(body_surface(askew, "bar").value(), {0.012, 20'000}, {}, "bar");
  if (!bar) MESSAGE(bar.error().message());
  REQUIRE(bar);
  const Eigen::VectorXd exact = mode_frequencies(box({0.3, 0.05, 0.04}, 20, 4, 4), 6),
                        ours = mode_frequencies(bar->mesh, 6);
  const double worst = (ours.array() / exact.array() - 1).abs().maxCoeff();
  MESSAGE(fmt::format("bar, {} elements: worst {:.3f} %", bar->mesh.tets.size(), 100 * worst));
  CHECK(worst < 0.003);

  const auto ball =
      netgen_fill(body_surface(test::icosphere(0.1, 4), "ball").value(), {0.03, 20'000}, {}, "ball");
  REQUIRE(ball);
  const double unit = std::sqrt(test::steel().shear_modulus() / 7850) / (tau * 0.1);
  const Eigen::VectorXd sphere = mode_frequencies(ball->mesh, 10) / unit;  // Lamb: 2.50113 (5), 2.64622 (5)
  MESSAGE(fmt::format("ball, {} elements: {:.5f} to {:.5f}, {:.5f} to {:.5f}", ball->mesh.tets.size(),
                      sphere[0], sphere[4], sphere[5], sphere[9]));
  CHECK((sphere.head(5).array() / 2.50113 - 1).abs().maxCoeff() < 0.003);
  CHECK((sphere.tail(5).array() / 2.64622 - 1).abs().maxCoeff() < 0.003);

  NetgenOptions little;
  little.memory_mb = 20;
  CHECK_FALSE(netgen_fill(pentagon(), {0.02, 2000}, little, "bar"));
  auto open = test::icosphere(0.1, 2);
  open.triangles.pop_back();
  const auto refused = netgen_fill(body_surface(open, "open").value(), {0.03, 2000}, {}, "open");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message().find("closed") != std::string::npos);
}
