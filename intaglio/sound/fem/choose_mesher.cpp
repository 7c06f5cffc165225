#include "intaglio/sound/fem/choose_mesher.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "intaglio/sound/fem/flat_frame.h"

namespace intaglio::sound {

namespace {

constexpr double sharp_cosine = 0.866;  // of the angle between normals: 30 degrees
constexpr double along_cosine = 0.985;  // 10 degrees
constexpr double least_skew = 0.05;     // of the bounding box's diagonal: length of such edges
constexpr std::size_t most_triangles = 20'000;
constexpr double most_seconds = 20;

}  // namespace

bool has_skew_edges(const BodySurface& body, double element_size) {
  const Mat3 axes = flat_frame(body.points, body.triangles);
  std::vector<Vec3> normals;
  for (const Triangle& t : body.triangles) {
    const Vec3& o = body.points[std::size_t(t[0])];
    normals.emplace_back(
        (body.points[std::size_t(t[1])] - o).cross(body.points[std::size_t(t[2])] - o).normalized());
  }
  const auto is_along = [&](const Vec3& n) {
    return (axes.transpose() * n).cwiseAbs().maxCoeff() > along_cosine;
  };
  std::map<std::pair<int, int>, std::size_t> first;
  double length = 0;
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = body.triangles[t][k], b = body.triangles[t][(k + 1) % 3];
      const auto [other, is_new] = first.try_emplace(std::minmax(a, b), t);
      if (is_new) continue;
      const Vec3 &m = normals[other->second], &n = normals[t];
      if (m.dot(n) < sharp_cosine && !(is_along(m) && is_along(n)))
        length += (body.points[std::size_t(a)] - body.points[std::size_t(b)]).norm();
    }
  }
  return length > least_skew * (body.high - body.low).norm() && length * element_size < body.area;
}

Result<FilledSurface> fill_by(Mesher mesher, const BodySurface& body, const FillOptions& options,
                              const NetgenOptions& netgen, const std::string& name) {
  if (mesher == Mesher::netgen) return netgen_fill(body, options, netgen, name);
  std::string note;
  if (mesher == Mesher::automatic && body.is_closed() && body.thickness == 0 && body.shells == 1 &&
      body.triangles.size() <= most_triangles && has_skew_edges(body, options.element_size)) {
    NetgenOptions limited = netgen;
    limited.seconds = std::min(netgen.seconds, most_seconds);
    if (limited.program.empty() && find_netgen().empty()) {
      note =
          "its sharp edges run across the lattice and are cut off a little; Netgen, which is not installed (script/setup netgen), keeps them";
    } else {
      auto filled = netgen_fill(body, options, limited, name);
      if (filled) return filled;
      note = fmt::format("Netgen could not fill it, so the lattice did ({})", filled.error().message());
    }
  }
  auto filled = fill_surface(body, options, name);
  if (filled && !note.empty()) filled->notes.push_back(note);
  return filled;
}

}  // namespace intaglio::sound
