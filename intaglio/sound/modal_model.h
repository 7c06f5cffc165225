// A body as its modes: all that sound needs to know of it.
//
// Immutable once baked, shared by any number of sounding bodies, safe to ask from any thread. Mode m has
// angular frequency omega, damping d = (alpha + beta omega^2) / 2, and rings as e^(-d t) sin(omega_d t),
// omega_d^2 = omega^2 - d^2, so that T60 = ln(1000) / d. Shapes are mass-normalised (kg^-1/2): an impulse j
// (N s) at a point adds phi . j to the modal velocity. Positions are in the body's own frame, metres. Source:
// paper §1.2.5 and §1.4; Shabana, "Theory of Vibration".
#pragma once

#include <span>
#include <string>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/core/hash.h"
#include "intaglio/core/material.h"
#include "intaglio/sound/fem/modes.h"
#include "intaglio/sound/fem/tet_mesh.h"
#include "intaglio/sound/triangle_grid.h"

namespace intaglio::sound {

struct ModalModel {
  std::string name;
  std::string source;  // its identity: the hash of what it was baked from and how (bake_inputs), or empty
  Material material;
  double mass = 0;      // kg
  double area = 0;      // m^2, of the surface
  double residual = 0;  // the worst |K u - lambda M u| / (lambda |M u|) of its modes

  std::vector<double> angular_frequency;  // omega, rad/s, ascending
  std::vector<double> damping;            // d, 1/s; always below omega
  std::vector<double> radiation;          // Pa at 1 m for a modal velocity of 1, with sign (radiation.h)

  std::vector<Vec3> points;         // of the surface, as many as sound needs
  std::vector<Triangle> triangles;  // outward
  std::vector<float>
      shapes;  // point by point: x of every mode, then y, then z; baked ones of 16 bits (round_shapes)
  TriangleGrid grid;
  // Of shapes between the points, linear over the triangles, against those of the elements: root mean square
  // over the surface, relative, of the worst mode.
  double shape_error = 0;
  // Of merging (merge_modes.h): how many modes there were, 0 if none were merged, and what it changed, dB.
  int modes_found = 0;
  double merge_error_db = 0, merge_error_rms_db = 0;

  int modes() const { return static_cast<int>(angular_frequency.size()); }
  Vec3 shape(int point, int mode) const;

  // out[m] = phi_m . direction at the surface point nearest to `point_local`, for the first out.size() modes.
  // Real-time: no allocation; one TriangleGrid query and nine multiplications a mode, about 1 microsecond for
  // 100 modes.
  void gains(const Vec3& point_local, const Vec3& direction_local, std::span<float> out) const;
};

// How finely the surface is sampled (sample_surface.h).
struct SampleOptions {
  double shape_error =
      0.06;                 // at most, at any point, of a mode's largest displacement; 0: every node is kept
  double distance = 0.004;  // of the bounding box's diagonal, between the old surface and the new
};

struct BakeOptions {
  std::string name;
  ModeOptions modes;
  SampleOptions sample = {};
  std::string source = {};
};

// Shapes are kept in 16 bits: as multiples of a unit for each mode, the power of two by which its largest
// value fits, so within a 32,767th of it (90 dB below). round_shapes() rounds a model's to that, so that a
// model read is the model that was written; again it changes nothing.
void round_shapes(ModalModel& model);
std::vector<float> shape_units(const ModalModel& model);
std::vector<std::int16_t> rounded_shapes(const ModalModel& model, std::span<const float> units);

// Raised when models of the same inputs come out differently.
inline constexpr int baker_version = 4;

// The identity of a model begins with these; whoever bakes adds what the mesh is made from. Equal identities
// are the same model, within the tolerances of docs/determinism.md if it was baked on other machines.
Hash bake_inputs(const Material& material, const BakeOptions& options);

// Modal analysis of a free body. Overdamped modes do not ring and are left out. Takes seconds: see
// fem/modes.h.
Result<ModalModel> bake(const TetMesh& mesh, const Material& material, const BakeOptions& options = {});

}  // namespace intaglio::sound
