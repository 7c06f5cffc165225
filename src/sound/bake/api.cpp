#include <utility>

#include "intaglio/bake.h"
#include "sound/api.h"
#include "sound/bake/bake.h"
#include "sound/bake/fem/fill_surface.h"
#include "sound/bake/fem/mesher.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/bake/merge_modes.h"

namespace intaglio {

namespace {

sound::BakeOptions bake_options(const BakeOptions& from) {
  sound::BakeOptions options;
  options.name = from.name;
  options.modes.count = from.modes;
  options.modes.max_frequency = from.max_frequency;
  options.modes.progress = from.progress;
  return options;
}

// Of a sphere, a box or a cylinder.
Result<sound::SolidShape> solid_of(const Shape& shape) {
  using Kind = sound::SolidShape::Kind;
  sound::SolidShape solid;
  if (const auto* s = std::get_if<Sphere>(&shape)) solid = {Kind::sphere, Vec3::Constant(2 * s->radius)};
  if (const auto* s = std::get_if<Box>(&shape)) solid = {Kind::box, 2 * s->half};
  if (const auto* s = std::get_if<Cylinder>(&shape))
    solid = {Kind::cylinder, Vec3(2 * s->radius, 2 * s->half_height, 2 * s->radius)};
  if (!(solid.size.minCoeff() > 0) || !solid.size.allFinite())
    return fail("bake", "the shape is not a sphere, box or cylinder with a size", "bake another one as a mesh");
  return solid;
}

double size_of_elements(const BakeOptions& options, double volume, double area, const Material& material) {
  return options.element_size ? *options.element_size
                              : sound::element_size(volume, area, material, bake_options(options).modes);
}

Result<ModalModel> baked(const sound::TetMesh& elements, const Material& material, const BakeOptions& options) {
  auto model = sound::bake(elements, material, bake_options(options));
  if (!model) return tl::unexpected(model.error());
  if (model->modes() == 0)
    return fail("bake", "no mode rings in the range",
                "a small or stiff body rings higher (max_frequency), a well damped one not at all; sizes are metres");
  sound::merge_modes(*model, options.merge_db);
  return handle_of(std::move(*model));
}

}  // namespace

Result<ModalModel> bake(const Shape& shape, const MaterialChoice& material, const BakeOptions& options) {
  const auto values = material.material();
  if (!values) return tl::unexpected(values.error());
  if (const auto sane = sound::check_material(*values); !sane) return tl::unexpected(sane.error());
  const auto solid = solid_of(shape);
  if (!solid) return tl::unexpected(solid.error());
  const double size = size_of_elements(options, solid->volume(), solid->area(), *values);
  return baked(solid->mesh(size, options.max_elements), *values, options);
}

Result<ModalModel> bake(const TriangleMesh& mesh, const MaterialChoice& material, const BakeOptions& options) {
  const std::string name = options.name.empty() ? "mesh" : options.name;
  const auto values = material.material();
  if (!values) return tl::unexpected(values.error());
  if (const auto sane = sound::check_material(*values); !sane) return tl::unexpected(sane.error());
  const auto surface = sound::body_surface(mesh, name, options.thickness);
  if (!surface) return tl::unexpected(surface.error());
  sound::FillOptions fill{size_of_elements(options, surface->volume, surface->area, *values), options.max_elements};
  if (!options.element_size && options.thickness == 0 && surface->is_closed() &&
      sound::has_skew_edges(*surface, fill.element_size))
    fill.element_size *= sound::at_skew_edges;
  auto filled = sound::fill_by(sound::Mesher::automatic, *surface, fill, {}, name);
  if (!filled) return tl::unexpected(filled.error());
  return baked(filled->mesh, *values, options);
}

}  // namespace intaglio
