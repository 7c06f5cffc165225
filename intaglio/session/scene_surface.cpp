#include "intaglio/session/scene_surface.h"

#include "intaglio/core/nested_error.h"
#include "intaglio/session/covered_texels.h"
#include "intaglio/session/scene_base.h"
#include "intaglio/surface/builtin/builtin.h"
#include "intaglio/surface/import.h"
#include "intaglio/surface/maps.h"
#include "intaglio/surface/mesh/mesh_shapes.h"

namespace intaglio::session {

namespace {

// On its rectangle.
Result<SceneSurface> make_flat(const SurfaceScene& from) {
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

Result<SceneSurface> make_one(const SurfaceScene& from) {
  SurfaceScene measured = from;
  std::optional<surface::MeshPlacement> base;
  if (from.base) {
    auto made = make_base(*from.base, {from.position, rotation_of(from.rotation)});
    if (!made) return tl::unexpected(with_where(from.base->line, made.error()));
    measured.size = texture_size(made->mesh());
    base = std::move(*made);
  }
  auto out = make_flat(measured);
  if (!out) return tl::unexpected(with_where(from.line, out.error()));
  if (!base) return out;
  auto curved = surface::ReliefMesh::make(out->surface, std::move(*base));
  if (!curved) return tl::unexpected(with_where(from.base->line, curved.error()));
  out->curved = std::move(*curved);
  return out;
}

// Of a body the box must be left between its reliefs.
Result<std::vector<SceneSurface>> make_reliefs(const BodyScene& body) {
  std::vector<SceneSurface> out;
  double depth = 0;
  for (const SurfaceScene& relief : body.reliefs) {
    auto made = make_one(relief);
    if (!made) return tl::unexpected(made.error());
    if (!made->curved) {
      depth += made->surface->max_depth();
      made->quad =
          std::make_shared<const surface::TriangleMesh>(surface::make_quad(made->surface->placement()));
    }
    out.push_back(std::move(*made));
  }
  const auto* box = std::get_if<contact::Box>(&body.body.shape);
  if (box != nullptr && depth > 1.8 * box->half.y())
    return tl::unexpected(with_where(
        body.reliefs.front().line,
        {body.reliefs.front().texture,
         fmt::format("is {:.3g} m deep on a {} that is {:.3g} m thick", depth, body.name, 2 * box->half.y()),
         "give a lesser depth"}));
  return out;
}

}  // namespace

dynamics::ShapeBody textured(const BodyScene& body, const std::vector<SceneSurface>& reliefs) {
  dynamics::ShapeBody out = body.body;
  for (const SceneSurface& relief : reliefs) {
    if (relief.curved) {
      out.skin = relief.curved;
    } else {
      out.faces.push_back(relief.surface);
    }
  }
  return out;
}

Result<SceneSurface> make_surface(const Scene& scene) {
  auto floor = make_one(scene.surface);
  if (!floor) return floor;
  for (const SurfaceScene& ground : scene.grounds) {
    auto made = make_one(ground);
    if (!made) return made;
    floor->grounds.push_back(std::move(*made));
  }
  if (auto checked = check_covered_texels(scene, *floor); !checked) return tl::unexpected(checked.error());
  for (const BodyScene& body : scene.bodies) {
    auto made = make_reliefs(body);
    if (!made) return tl::unexpected(made.error());
    floor->reliefs.push_back(std::move(*made));
  }
  return floor;
}

}  // namespace intaglio::session
