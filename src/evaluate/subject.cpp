#include "evaluate/subject.h"

#include "evaluate/cpu_timer.h"
#include "scene/voices/voices.h"

namespace intaglio::evaluate {

namespace {

constexpr std::array<Candidate, kinds> all = {{
    {Kind::flat, "flat", "flat", Representation::flat},
    {Kind::normal_paper, "normal_paper", "normal map, the paper's way", Representation::normal, true},
    {Kind::normal, "normal", "normal map, ours", Representation::normal},
    {Kind::relief_paper, "relief_paper", "relief, the paper's way", Representation::relief, true},
    {Kind::relief, "relief", "relief, ours", Representation::relief},
    {Kind::mesh_256, "mesh_256", "coarse mesh, 256²", Representation::relief, false, 256},
    {Kind::mesh_512, "mesh_512", "fine mesh, 512²", Representation::relief, false, 512},
}};

}  // namespace

std::span<const Candidate, kinds> candidates() {
  return all;
}

Result<Subject> Subject::make(const SubjectOptions& options) {
  Subject subject;
  subject.options_ = options;
  const Candidate& ours = all[std::size_t(Kind::relief)];
  const Candidate& papers = all[std::size_t(Kind::relief_paper)];
  {
    const CpuTimer timer(subject.offline_.import);
    auto fused = scene::make_surface(subject.scene(ours));
    if (!fused) return tl::unexpected(fused.error());
    subject.fused_ = std::move(*fused);
  }
  scene::Scene raw = subject.scene(papers);
  raw.surface.representation = Representation::normal;  // a normal map alone has no raw depth
  raw.surface.depth = subject.fused_.surface->max_depth();
  auto raw_surface = scene::make_surface(raw);
  if (!raw_surface) return tl::unexpected(raw_surface.error());
  subject.raw_ = std::move(*raw_surface);
  auto truth = make_reference(options.texture, *subject.fused_.surface, options.grid);
  if (!truth) return tl::unexpected(truth.error());
  subject.reference_ = std::move(*truth);
  {
    const CpuTimer timer(subject.offline_.meshes);
    for (std::size_t k = 0; k < 2; ++k)
      subject.meshes_[k] = std::make_shared<const MeshFloor>(
          *subject.reference_, subject.fused_.surface->placement(), k == 0 ? 256 : 512);
  }
  const CpuTimer timer(subject.offline_.modal);
  auto voices = scene::bake_voices(subject.scene(ours), subject.fused_, {.shipped = ""});
  if (!voices) return tl::unexpected(voices.error());
  subject.voices_ = std::move(voices->bodies);
  return subject;
}

scene::Scene Subject::scene(const Candidate& candidate) const {
  scene::Scene scene;
  scene.name = options_.texture;
  scene.surface.texture = options_.texture;
  scene.surface.size = {options_.size, options_.size};
  scene.surface.depth = options_.depth;
  scene.surface.thickness = 0.05 * options_.size;
  scene.surface.material = options_.material;
  scene.surface.representation = candidate.representation;
  scene.surface.mode = candidate.is_papers ? surface::ImportMode::raw : surface::ImportMode::fused;
  scene.allowed_memory = options_.allowed_memory;
  if (candidate.is_papers) {
    scene.physics.method = dynamics::ContactMethod::directional;
    scene.physics.normal_method = dynamics::NormalMethod::literal;
  }
  scene::BallSettings ball;
  ball.radius = ball_radius();
  ball.material = *find_material("plastic");
  ball.position = {0, 2 * options_.size, 0};
  scene.balls = {ball};
  scene::PenSettings pen;
  pen.length = 0.2 * options_.size;
  pen.radius = 0.007 * options_.size;
  pen.workspace.scale = hand_scale;
  pen.tip_radius = tip_radius;
  pen.spring.stiffness = 1000;
  pen.material.friction = 0.05;  // a tip of PTFE: others jam at steep walls
  if (candidate.is_papers) pen.method = haptics::HapticMethod::plane;
  pen.path = {{0, {0, options_.size, 0}}};
  scene.pen = pen;
  return scene;
}

const scene::SceneSurface& Subject::surface(const Candidate& candidate) const {
  return candidate.is_papers ? raw_ : fused_;
}

std::shared_ptr<const MeshFloor> Subject::mesh(const Candidate& candidate) const {
  if (candidate.mesh_cells == 0) return nullptr;
  return meshes_[candidate.mesh_cells == 256 ? 0 : 1];
}

std::vector<sound::SoundBody> Subject::voices(const Candidate& candidate) const {
  std::vector<sound::SoundBody> bodies = voices_;
  // A mesh sounds by the engine's impulses alone.
  const bool is_textured = candidate.representation != Representation::flat && candidate.mesh_cells == 0;
  for (sound::SoundBody& body : bodies)
    if (body.id == floor_body) {
      body.textures.clear();
      if (is_textured) body.textures = {surface(candidate).surface};
    }
  return bodies;
}

}  // namespace intaglio::evaluate
