#include "intaglio/sound/fem/choose_mesher.h"

#include <algorithm>
#include <cmath>

#include "intaglio/sound/fem/flat_frame.h"
#include "intaglio/sound/fem/sharp_edges.h"

namespace intaglio::sound {

namespace {

constexpr double along_cosine = 0.985;  // 10 degrees
constexpr double least_skew = 0.05;     // of the bounding box's diagonal: length of such edges
constexpr std::size_t most_triangles = 20'000;
constexpr double most_seconds = 20;

}  // namespace

bool has_skew_edges(const BodySurface& body, double element_size) {
  std::vector<SharpEdge> skew = sharp_edges_of(body);
  const double least = least_skew * (body.high - body.low).norm();
  if (!(length_of(skew, body) > least)) return false;
  const Mat3 axes = flat_frame(body.points, body.triangles);
  const auto is_along = [&](const Vec3& n) {
    return (axes.transpose() * n).cwiseAbs().maxCoeff() > along_cosine;
  };
  std::erase_if(skew, [&](const SharpEdge& e) { return is_along(e.left) && is_along(e.right); });
  const double length = length_of(skew, body);
  return length > least && length * element_size < body.area;
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
          "its sharp edges run across the lattice, which keeps most of them; Netgen, which is not installed (script/setup netgen), keeps them all";
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
