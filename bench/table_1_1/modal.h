// Modal analysis for Table 1.1: the tile of 0.3 m by each representation, analysed by ours and, where it
// fits, by the dense method.
#pragma once

#include <optional>

namespace intaglio::bench {

// Figures of one analysis, in a process of its own.
struct ModalCost {
  double vertices = 0, unknowns = 0;
  double elements = 0;       // where they are known
  double mesh_bytes = 0;     // 32 a vertex of a surface and 12 a triangle; 12 a node and 40 a tetrahedron
  double offline_bytes = 0;  // peak of the resident set, the mesh itself not counted
  double runtime_bytes = 0;  // of the model and of a bank that plays it
  double seconds = 0;        // CPU
  int modes = 0;
};

// The paper's for normal maps: a spring-mass shell of 14 x 14 masses, 588 unknowns.
std::optional<ModalCost> analyse_spring_shell();
// For relief maps, as scenes do: finite elements of the slab under the texture.
std::optional<ModalCost> analyse_slab();
// A closed tile of `texels` x `texels` vertices on its top by intaglio::bake, from its triangles alone:
// elements follow the waves.
std::optional<ModalCost> analyse_mesh(int texels);
// Elements of `cells` x `cells` squares, each node of which is a node of a mesh as fine as that.
std::optional<ModalCost> analyse_every_vertex(int cells);

// The dense method beside ours, on the same matrices.
struct DenseCost {
  double unknowns = 0;
  double dense_bytes = 0, dense_seconds = 0;  // all modes, as it computes no fewer
  double our_bytes = 0, our_seconds = 0;      // 100 modes
  double difference = 0;                      // relative, the largest of those frequencies
};

// Whether LAPACK was there when this was built.
bool has_dense_method();
// A slab of `cells` x `cells` x 1 bricks of elements: 9 (2 cells + 1)^2 unknowns.
std::optional<DenseCost> compare_dense(int cells);

// Bytes of one dense matrix of so many unknowns.
inline double dense_matrix_bytes(double unknowns) {
  return 8 * unknowns * unknowns;
}

}  // namespace intaglio::bench
