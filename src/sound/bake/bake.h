// Modal analysis: from a mesh and a material to a ModalModel, by ten-node elements (bake), four-node elements
// (bake_linear) or a spring-mass shell (bake_spring_shell).
//
// Every bake takes seconds, runs on the caller's thread, and uses one thread. All of them look at
// options.modes.stop between steps and, when it is set, return an error within some tenths of a second; only
// MUMPS's numerical factorisation cannot be interrupted (0.2 s at 20,000 degrees of freedom, 5 s at 300,000).
#pragma once

#include <atomic>
#include <string>
#include <vector>

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
  std::string identity = {};  // of the model, see bake_hash()
};

// Bump when baking the same inputs gives a different model.
inline constexpr int baker_version = 4;

// The first part of a model's identity; the caller adds what the mesh is made from. Equal identities are the
// same model, within the tolerances of docs/determinism.md if it was baked on another machine.
Hash bake_hash(const Material& material, const BakeOptions& options);

// Modal analysis of a free body. Overdamped modes do not ring and are left out. Cost: see fem/modes.h.
Result<ModalModel> bake(const TetMesh& mesh, const Material& material, const BakeOptions& options = {});

// With linear tetrahedra between the corners of `mesh`; mid-edge nodes are interpolated. A quarter of the
// degrees of freedom, and thin bodies come out tens of per cent sharp: for reproducing the paper's pitch.
Result<ModalModel> bake_linear(const TetMesh& mesh, const Material& material,
                               const BakeOptions& options = {});

// A hollow shell of `thickness` metres over the surface, open or closed (paper §1.4): masses at its vertices,
// a spring E t along every edge, and at every edge a hinge with the shell's bending stiffness D = E t^3 / (12
// (1 - nu^2)), since springs alone do not resist out-of-plane motion. The surface must be connected. The
// pitch depends on the triangles; well-shaped ones give it within some ten per cent. `name` appears in
// errors. Sources: Raghuvanshi & Lin, "Interactive sound synthesis for large scale environments", 2006
// (springs); Grinspun et al., "Discrete shells", 2003 (hinges).
Result<ModalModel> bake_spring_shell(const BodySurface& surface, double thickness, const Material& material,
                                     const BakeOptions& options, const std::string& name);

// The steps that the three have in common.

struct ModalSurface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<int> nodes;  // of each point, among the rows of the modes
  double thickness = 0;    // m, of a shell modelled by one sheet; 0: the surface of a body
};

// Validates the material.
Result<void> check_material(const Material& material);

// The boundary as flat triangles, four for each curved one.
ModalSurface boundary_surface(const TetMesh& mesh);

// Keeps the underdamped modes, samples the surface and computes the radiation.
Result<ModalModel> make_modal_model(const Modes& modes, ModalSurface surface, double mass,
                                    const Material& material, const BakeOptions& options);

// Largest element size that resolves the requested modes, m.
//
// A quarter of the shortest shear wave among them, which leaves the last of 100 modes of a ball 0.4 % sharp
// at most and 0.1 % on average; for a thin body (thickness 2 V / A) a fifth of the shortest bending wave, if
// that is less. The shear wave is the one at the highest frequency, or at the frequency of mode `count`,
// estimated by Weyl's law, if lower; the bending wave is no shorter than that of the last of `count` modes of
// a plate, which has one mode per wavelength^2 / pi of area. Sources: Cremer, Heckl & Petersson,
// "Structure-Borne Sound", 2005; Dupuis, Mazo & Onsager, "Surface specific heat of an isotropic solid at low
// temperatures", 1960 (Weyl's law with the free surface).
double element_size(double volume, double area, const Material& material, const ModeOptions& modes);

}  // namespace intaglio::sound
