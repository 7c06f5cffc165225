#include "intaglio/session/scene_surface.h"

#include "intaglio/surface/builtin/builtin.h"
#include "intaglio/surface/import.h"
#include "intaglio/surface/maps.h"

namespace intaglio::session {

namespace {

Result<SceneSurface> make_one(const SurfaceScene& from) {
  SceneSurface out;
  out.material = *find_material("brick");
  surface::Texels texels;
  double depth = 0;
  auto recipe = surface::recipe_named(from.texture);
  if (!recipe) return tl::unexpected(recipe.error());
  if (*recipe) {
    const surface::BuiltinMaterial& about = (*recipe)->about;
    texels = surface::to_texels(surface::make_texture(**recipe, surface::builtin_size));
    out.material = about.material;
    out.roughness = about.roughness;
    depth = about.depth_fraction * from.size.x();
    if (from.depth) surface::rescale_normals(texels.normal, *from.depth / depth);
    depth = from.depth.value_or(depth);
  } else {
    surface::ImportOptions options;
    options.green = from.green;
    options.polarity = from.polarity;
    options.mode = from.mode;
    options.edge = from.edge;
    if (from.depth) options.depth_fraction = *from.depth / from.size.x();
    auto imported = surface::import_texture(from.texture, options);
    if (!imported) return tl::unexpected(imported.error());
    out.notes = imported->notes;
    for (const std::string& warning : imported->warnings) out.notes.push_back("warning: " + warning);
    depth = imported->depth_fraction * from.size.x();
    texels = std::move(imported->texels);
  }
  if (from.material) out.material = *from.material;
  if (texels.depth.empty() && from.representation == Representation::relief) {
    return fail(from.texture, "has normals but no depth",
                "take maps = \"fused\", give a height map too, or use --representation normal");
  }
  const surface::Placement placement(from.position, rotation_of(from.rotation), from.size.x(), from.size.y());
  out.surface = std::make_shared<const surface::Surface>(std::move(texels), placement, depth, from.edge);
  return out;
}

}  // namespace

Result<SceneSurface> make_surface(const Scene& scene) {
  auto floor = make_one(scene.surface);
  if (!floor) return floor;
  for (const SurfaceScene& ground : scene.grounds) {
    auto made = make_one(ground);
    if (!made) return made;
    floor->grounds.push_back(std::move(*made));
  }
  return floor;
}

}  // namespace intaglio::session
