// A texture under evaluation: its reference, and the seven representations of it that are compared, each as
// a scene with one ball and one pen.
//
// All representations are made of the same texture at the same size and depth. The paper's are made of the
// raw maps and use its methods (Sterling & Lin 2016, §1.2 and §1.3); ours use the fused maps and the
// defaults of scenes. The meshes are regular grids of the reference's heights, as a game would have them
// instead of a texture: Bullet collides with them, our own proxy touches their triangles, and they are drawn
// without a normal map (§1.4.1). Making a subject takes 2 to 6 s; afterwards it is immutable.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evaluate/mesh_floor.h"
#include "evaluate/reference.h"
#include "scene/scene.h"
#include "scene/surfaces.h"
#include "sound/synthesizer.h"

namespace intaglio::evaluate {

enum class Kind { flat, normal_paper, normal, relief_paper, relief, mesh_256, mesh_512 };
inline constexpr std::size_t kinds = 7;

struct Candidate {
  Kind kind;
  const char* key;    // in JSON
  const char* title;  // on pages
  Representation representation;
  bool is_papers = false;  // its methods, on raw maps
  int mesh_cells = 0;      // a side; 0: a texture
};
std::span<const Candidate, kinds> candidates();

struct SubjectOptions {
  std::string texture = "brick";  // as in a scene's [surface]
  double size = 1;                // m, side of the square; the ball, the tip and the hand scale with it
  std::optional<double> depth;    // m; unset: as the texture implies
  std::optional<Material> material;
  int grid = 1024;  // points a side of the reference
  std::uint64_t allowed_memory = default_allowed_memory;
};

class Subject {
 public:
  static Result<Subject> make(const SubjectOptions& options);

  const SubjectOptions& options() const { return options_; }
  const Reference& reference() const { return *reference_; }
  // A scene of the size with a ball and a pen, both off the floor, in this representation.
  scene::Scene scene(const Candidate& candidate) const;
  const scene::SceneSurface& surface(const Candidate& candidate) const;
  // Null but for meshes.
  std::shared_ptr<const MeshFloor> mesh(const Candidate& candidate) const;
  // Floor, ball and pen as sounding bodies.
  std::vector<sound::SoundBody> voices(const Candidate& candidate) const;
  const std::vector<std::string>& notes() const { return fused_.notes; }

  double ball_radius() const { return 0.04 * options_.size; }  // m
  static constexpr double tip_radius = 0.001;                  // m
  static constexpr double hand_scale = 1;                      // scene metres per metre of the hand
  // Offline work, thread-CPU s.
  struct Offline {
    double import = 0, meshes = 0, modal = 0;
  };
  const Offline& offline() const { return offline_; }

 private:
  SubjectOptions options_;
  scene::SceneSurface fused_, raw_;
  std::shared_ptr<const Reference> reference_;
  std::array<std::shared_ptr<const MeshFloor>, 2> meshes_;  // 256, 512
  std::vector<sound::SoundBody> voices_;
  Offline offline_;
};

}  // namespace intaglio::evaluate
