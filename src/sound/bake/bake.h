// From modes of nodes to a modal model: what ringing modes have, how they radiate, the surface sampled.
#pragma once

#include "core/hash.h"
#include "intaglio/material.h"
#include "sound/bake/fem/body_surface.h"
#include "sound/bake/fem/modes.h"
#include "sound/bake/sample_surface.h"
#include "sound/modal_model.h"

namespace intaglio::sound {

struct BakeOptions {
  std::string name;
  ModeOptions modes;
  SampleOptions sample = {};
  std::string source = {};
};

// Raised when models of the same inputs come out differently.
inline constexpr int baker_version = 4;

// The identity of a model begins with these; whoever bakes adds what the mesh is made from. Equal identities
// are the same model, within the tolerances of docs/determinism.md if it was baked on other machines.
Hash bake_inputs(const Material& material, const BakeOptions& options);

// Modal analysis of a free body. Overdamped modes do not ring and are left out. Takes seconds: see
// fem/modes.h.
Result<ModalModel> bake(const TetMesh& mesh, const Material& material, const BakeOptions& options = {});

struct ModalSurface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<int> nodes;  // of each point, among the rows of the modes
  double thickness = 0;    // m, of a shell that has one side here; 0: the surface of a body
};

// Overdamped modes are left out.
ModalModel model_of_modes(const Modes& modes, ModalSurface surface, double mass, const Material& material,
                          const BakeOptions& options);

// What would make a bake meaningless.
Result<void> check_material(const Material& material);

// The boundary as flat triangles, four to each curved one.
ModalSurface boundary_surface(const TetMesh& mesh);

// The coarser ways to a modal model, for comparison with `bake`: four-node elements, and the paper's
// spring-mass shell (paper §1.4).

// With linear tetrahedra between the corners of `mesh`; its mid-edge nodes follow. A quarter of the degrees
// of freedom, and thin bodies come out tens of per cent sharp: use it where the paper's own pitch is wanted.
Result<ModalModel> bake_linear(const TetMesh& mesh, const Material& material,
                               const BakeOptions& options = {});

// A hollow shell of `thickness` metres over the surface, open or closed: masses at its vertices, a spring
// E t along every edge, and against folding a hinge with the shell's bending stiffness D = E t^3 / (12 (1 -
// nu^2)), since springs alone leave flat parts loose. One piece; the pitch depends on the triangles, evenly
// shaped ones give it within some ten per cent. `name` is for errors. Sources: Raghuvanshi & Lin,
// "Interactive sound synthesis for large scale environments", 2006 (springs); Grinspun et al., "Discrete
// shells", 2003 (hinges).
Result<ModalModel> bake_spring_shell(const BodySurface& surface, double thickness, const Material& material,
                                     const BakeOptions& options, const std::string& name);

// How large elements may be for the modes that are wanted.

// A quarter of the shortest shear wave among them, metres, which leaves the last of 100 modes of a ball 0.4 %
// sharp at most and 0.1 % in the mean; of a thin body (thickness 2 V / A) a fifth of the shortest bending
// wave, if that is less. The shear wave is that at the highest frequency, or of the last of `count` modes of
// a solid by Weyl's law; the bending wave no shorter than the last of `count` modes of a plate has it: one
// mode takes an area of wavelength^2 / pi. Sources: Cremer, Heckl & Petersson, "Structure-Borne Sound", 2005;
// Dupuis, Mazo & Onsager, "Surface specific heat of an isotropic solid at low temperatures", 1960 (Weyl's law
// with the free surface).
double element_size(double volume, double area, const Material& material, const ModeOptions& modes);

}  // namespace intaglio::sound
