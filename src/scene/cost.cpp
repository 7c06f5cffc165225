#include "scene/cost.h"

#include <fmt/format.h>
#include <algorithm>
#include <set>
#include <variant>

#include "haptics/servo.h"
#include "intaglio/event.h"
#include "scene/surfaces.h"
#include "surface/import.h"
#include "surface/recipes/builtin.h"

namespace intaglio::scene {

namespace {

constexpr double program = 150e6;  // code, the driver's compiler, solvers

// Each different texture once: its surface, and on the device 15 bytes a texel and 5 of the colour map. The
// largest is imported, or uploaded, while the others are there.
double texture_bytes(const Scene& scene) {
  std::set<TextureKey> seen;
  double kept = 0, largest = 0;
  const auto add = [&](const SurfaceSettings& from) {
    if (!seen.insert(texture_key(from)).second) return;
    const auto extent = surface::texture_extent(from.texture, surface::default_texture_size);
    surface::ImportOptions options;
    options.mode = from.mode;
    options.edge = from.edge;
    const double alone = extent.surface_bytes() + 11 * extent.texels + 6 * extent.coloured;
    kept += alone;
    largest = std::max(largest, extent.import_bytes(options) - alone);
  };
  add(scene.surface);
  for (const SurfaceSettings& ground : scene.grounds) add(ground);
  for (const BodySettings& body : scene.bodies)
    for (const SurfaceSettings& relief : body.reliefs) add(relief);
  for (const Cue cue : all_cues) {
    SurfaceSettings other = scene.surface;
    if (scene.cues[cue].texture) put_texture(other, *scene.cues[cue].texture);
    add(other);
  }
  return kept + std::max(0.0, largest);
}

// A curved base: its triangles, their search and tangents, and three tetrahedra on the device.
double base_bytes(const BaseSettings& base) {
  constexpr double bytes_per_triangle = 1200;
  const double around = std::max(64.0, base.repeat.x()), up = std::max(32.0, base.repeat.y());
  if (base.shape == BaseSettings::Shape::mesh) return 0;  // mesh_file.h checks it when it is read
  return bytes_per_triangle * 2 * around *
         (base.shape == BaseSettings::Shape::cylinder ? base.repeat.y() : up);
}

double bases_bytes(const Scene& scene) {
  double bytes = 0;
  const auto add = [&](const SurfaceSettings& surface) {
    if (surface.base) bytes += base_bytes(*surface.base);
  };
  for (const SurfaceSettings& ground : scene.grounds) add(ground);
  for (const BodySettings& body : scene.bodies)
    for (const SurfaceSettings& relief : body.reliefs) add(relief);
  return bytes;
}

// Rigid bodies, their modal banks, and room for the sounds that may drive them.
double bodies_bytes(const Scene& scene) {
  const double bank = 100.0 * scene.sound.modes + 80e3;
  double bytes = (10e3 + bank) * double(scene.balls.size() + scene.bodies.size() + scene.grounds.size());
  for (const BodySettings& body : scene.bodies)
    if (const auto* compound = std::get_if<contact::Compound>(&body.body.shape))
      bytes += 3e3 * double(compound->children->size());
  return bytes;
}

// Samples of 12 bytes, and pixels on their way to a file.
double picture_bytes(const VideoSettings& video) {
  const double pixels = double(video.width) * video.height;
  return (12 * video.supersample * video.supersample + 24) * pixels;
}

// A contact a step for every free body, the pen's ticks and contacts, the sound; in lists that grow by half.
double recording_bytes(const Scene& scene) {
  const double steps = scene.duration * scene.physics.rate;
  const auto is_free = [](const BodySettings& body) { return body.body.motion == dynamics::Motion::free; };
  const auto free = std::count_if(scene.bodies.begin(), scene.bodies.end(), is_free);
  double bytes =
      steps * (sizeof(ContactEvent) + sizeof(Vec3)) * double(scene.balls.size() + std::size_t(free));
  if (scene.pen)
    bytes += scene.duration * scene.pen->device.rate * (sizeof(haptics::ServoSample) + sizeof(ContactEvent));
  return 1.5 * bytes + 16 * scene.duration * scene.sound.sample_rate;
}

}  // namespace

MemoryCost memory_cost(const Scene& scene, Use use) {
  MemoryCost cost("program", program);
  cost.add("textures", texture_bytes(scene));
  cost.add("curved bases", bases_bytes(scene));
  cost.add("bodies", bodies_bytes(scene));
  cost.add("picture", picture_bytes(scene.video));
  if (use == Use::kept) cost.add("recording", recording_bytes(scene));
  return cost;
}

Result<void> check_cost(const Scene& scene, Use use) {
  const std::size_t bodies = scene.balls.size() + scene.bodies.size();
  if (bodies > max_bodies)
    return fail(scene.name, fmt::format("has {} bodies", bodies),
                fmt::format("at most {} are simulated", max_bodies));
  return check_memory(scene.name, memory_cost(scene, use), scene.allowed_memory);
}

}  // namespace intaglio::scene
