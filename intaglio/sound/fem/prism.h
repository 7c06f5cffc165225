// A prism of nodes as tetrahedra.
#pragma once

#include <array>

namespace intaglio::sound {

// The three tetrahedra of a prism with bottom 0 1 2 under top 3 4 5. Every side face is cut from its corner
// of smallest global index, so that neighbours agree: Dompierre et al., "How to subdivide pyramids, prisms
// and hexahedra into tetrahedra", 1999.
std::array<std::array<int, 4>, 3> prism_tets(std::array<int, 6> p);

}  // namespace intaglio::sound
