#include "intaglio/contact/curved_found.h"

#include <cmath>

#include "intaglio/surface/mesh/relief_rim.h"

namespace intaglio::contact {

namespace {

constexpr unsigned triangle_bits = 22;
static_assert(surface::max_mesh_triangles <= (std::size_t{1} << triangle_bits));

}  // namespace

std::uint64_t curved_feature_id(const surface::ReliefMesh& relief, int triangle, const Vec2& weights,
                                Part part, int index, int child) {
  constexpr double near = 1e-6;
  const auto bits = [](auto value, unsigned count) {
    return static_cast<std::uint64_t>(value) & ((std::uint64_t{1} << count) - 1);
  };
  const surface::MeshPlace place = surface::first_of(relief, triangle, weights);
  Vec2 first = Vec2::Zero(), on_line = Vec2::Zero();
  if (!relief.surface().is_flat()) {
    const Vec2 cells = relief.triangle(place.triangle).cells(place.weights);
    for (int axis = 0; axis < 2; ++axis) {
      first[axis] = std::floor(cells[axis] + near);
      on_line[axis] = cells[axis] - first[axis] < near ? 1 : 0;
    }
  }
  return bits(place.triangle, triangle_bits) | bits(static_cast<std::int64_t>(first[0]), 12) << 22 |
         bits(static_cast<std::int64_t>(first[1]), 12) << 34 |
         bits(static_cast<int>(on_line[0] + 2 * on_line[1]), 2) << 46 | bits(part, 2) << 48 |
         bits(index, 8) << 50 | bits(child, 6) << 58;
}

void report(const surface::ReliefMesh& relief, Candidates& found, ContactSet& set) {
  Candidates::Chosen chosen;
  const std::size_t count = found.choose(chosen);
  for (std::size_t k = 0; k < count; ++k) {
    const Candidate& c = *chosen[k];
    ContactPoint out{c.point, c.normal, c.normal, c.distance, Vec2::Zero(), c.feature};
    const int triangle = static_cast<int>(c.feature & ((std::uint64_t{1} << triangle_bits) - 1));
    if (const auto base = relief.under(triangle, c.point)) {
      out.uv = base->uv;
      out.n_s = base->direction_to_world(relief.surface().normal(base->uv));
    }
    set.points[set.count++] = out;
  }
}

}  // namespace intaglio::contact
