// Which mesher fills a body best: the lattice for whatever is round, lies along its own flat faces or is not
// clean; Netgen where sharp edges run across the lattice, which cuts them off (docs/bake.md has the figures).
#pragma once

#include "intaglio/sound/fem/netgen_fill.h"

namespace intaglio::sound {

enum class Mesher { automatic, lattice, netgen };

// Whether the surface has edges of more than 30 degrees between faces of which one is more than 25 degrees
// off the lattice, and these lie farther apart than an element: finer ones, a relief's, no mesher should
// follow.
bool has_skew_edges(const BodySurface& body, double element_size);
// Times the size that waves need: elements about such edges are not as well shaped as others.
inline constexpr double at_skew_edges = 0.7;

// By the mesher that is asked for. Automatic: Netgen for a closed surface of one shell with skew edges and at
// most 20,000 triangles, within 20 s; where it is not installed, or fails, the lattice, with a note that says
// so.
Result<FilledSurface> fill_by(Mesher mesher, const BodySurface& body, const FillOptions& options,
                              const NetgenOptions& netgen, const std::string& name);

}  // namespace intaglio::sound
