#include "scene/surfaces.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <variant>

#include "core/text.h"
#include "intaglio/error.h"
#include "intaglio/representation.h"
#include "mesh/api.h"
#include "mesh/mesh_file.h"
#include "mesh/triangle_mesh.h"
#include "scene/cost.h"
#include "surface/import.h"
#include "surface/maps.h"
#include "surface/recipes/builtin.h"

namespace intaglio::scene {

namespace {

// A texture as the surfaces of a scene share it: its texels, on a rectangle of no meaning.
struct Texture {
  surface::Surface surface;
  double depth_fraction = 0;   // full depth over the width
  bool has_own_depth = false;  // in metres: the depth that the scene gives is exact
  Material material = *find_material("brick");
  double roughness = SceneSurface().roughness;
  std::vector<std::string> notes;
};

surface::Surface unplaced(surface::Texels texels, surface::Edge edge) {
  return {std::move(texels), {Vec3::Zero(), Quat::Identity(), 1, 1}, 0, edge};
}

Result<Texture> generated(const surface::Recipe& recipe, const SurfaceSettings& from) {
  const surface::BuiltinMaterial& about = recipe.about;
  surface::Texels texels = surface::to_texels(surface::make_texture(recipe, surface::default_texture_size));
  if (from.depth)
    surface::rescale_normals(texels.normal, *from.depth / (about.depth_fraction * from.size.x()));
  return Texture{.surface = unplaced(std::move(texels), from.edge),
                 .depth_fraction = about.depth_fraction,
                 .has_own_depth = from.depth.has_value(),
                 .material = about.material,
                 .roughness = about.roughness,
                 .notes = {}};
}

Result<Texture> imported(const SurfaceSettings& from, std::uint64_t allowed_memory) {
  surface::ImportOptions options;
  options.green = from.green;
  options.polarity = from.polarity;
  options.mode = from.mode;
  options.edge = from.edge;
  options.allowed_memory = allowed_memory;
  if (from.depth) options.depth_fraction = *from.depth / from.size.x();
  auto read = surface::import_texture(from.texture, options);
  if (!read) return tl::unexpected(read.error());
  Texture out{.surface = unplaced(std::move(read->texels), from.edge),
              .depth_fraction = read->depth_fraction,
              .notes = std::move(read->notes)};
  for (const std::string& warning : read->warnings) out.notes.push_back("warning: " + warning);
  return out;
}

// Makes each texture of a scene once: a hundred grounds of one texture share its texels.
class Textures {
 public:
  explicit Textures(std::uint64_t allowed_memory) : allowed_memory_(allowed_memory) {}

  std::uint64_t allowed_memory() const { return allowed_memory_; }

  // The texture on a rectangle; `base` is ignored.
  Result<SceneSurface> place(const SurfaceSettings& from) {
    const auto found = find(from);
    if (!found) return tl::unexpected(found.error());
    const Texture& texture = **found;
    if (!texture.surface.has_depth() && from.representation == Representation::relief) {
      return fail(from.texture, "has normals but no depth",
                  "take maps = \"fused\", give a height map too, or use --representation normal");
    }
    SceneSurface out;
    out.material = from.material.value_or(texture.material);
    out.roughness = texture.roughness;
    out.notes = texture.notes;
    const surface::Placement placement(from.position, rotation_of(from.rotation), from.size.x(),
                                       from.size.y());
    const double depth = texture.has_own_depth ? *from.depth : texture.depth_fraction * from.size.x();
    out.surface = std::make_shared<const surface::Surface>(texture.surface.placed(placement, depth));
    return out;
  }

 private:
  Result<std::shared_ptr<const Texture>> find(const SurfaceSettings& from) {
    auto& texture = made_[texture_key(from)];
    if (texture) return texture;
    const auto recipe = surface::find_recipe(from.texture);
    if (!recipe) return tl::unexpected(recipe.error());
    auto made = *recipe ? generated(**recipe, from) : imported(from, allowed_memory_);
    if (!made) return tl::unexpected(made.error());
    return texture = std::make_shared<const Texture>(std::move(*made));
  }

  std::uint64_t allowed_memory_;
  std::map<TextureKey, std::shared_ptr<const Texture>> made_;
};

Result<SceneSurface> build_surface(const SurfaceSettings& from, Textures& textures) {
  SurfaceSettings measured = from;
  std::optional<surface::MeshPlacement> base;
  if (from.base) {
    auto made = make_base(*from.base, {from.position, rotation_of(from.rotation)}, textures.allowed_memory());
    if (!made) return tl::unexpected(with_where(from.base->line, made.error()));
    measured.size = surface::texture_size(made->mesh());
    base = std::move(*made);
  }
  auto out = textures.place(measured);
  if (!out) return tl::unexpected(with_where(from.line, out.error()));
  if (!base) return out;
  auto curved = surface::ReliefMesh::make(out->surface, std::move(*base));
  if (!curved) return tl::unexpected(with_where(from.base->line, curved.error()));
  out->curved = std::move(*curved);
  return out;
}

// Fails when the reliefs of a box would meet inside it.
Result<std::vector<SceneSurface>> make_reliefs(const BodySettings& body, Textures& textures) {
  std::vector<SceneSurface> out;
  double depth = 0;
  for (const SurfaceSettings& relief : body.reliefs) {
    auto made = build_surface(relief, textures);
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
         "use a smaller depth"}));
  return out;
}

}  // namespace

TextureKey texture_key(const SurfaceSettings& from) {
  std::optional<std::array<double, 2>> depth;
  if (from.depth) depth = {*from.depth, from.size.x()};
  return {from.texture, from.green, from.polarity, from.edge, from.mode, depth};
}

dynamics::ShapeBody textured(const BodySettings& body, const std::vector<SceneSurface>& reliefs) {
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

namespace {

// A flat thing of one grey, in place of a texture that is not shown.
std::shared_ptr<const surface::Surface> blank(const surface::Placement& placement, surface::Edge edge) {
  constexpr int side = 4;
  surface::Texels texels;
  texels.width = texels.height = side;
  texels.depth.assign(side * side, 0.0f);
  texels.normal.assign(side * side, Vec3::UnitZ());
  texels.colour = Image8(side, side, 3);
  std::fill(texels.colour.data.begin(), texels.colour.data.end(), std::uint8_t{150});
  return std::make_shared<const surface::Surface>(std::move(texels), placement, 0, edge);
}

void make_blank(SceneSurface& one) {
  one.surface = blank(one.surface->placement(), one.surface->edge());
  one.roughness = SceneSurface().roughness;
}

// The floor with another texture, or its own elsewhere: of the floor's material in both cases.
Result<SceneSurface> other_floor(const Scene& scene, const SceneSurface& floor, const CueSettings& cue,
                                 Textures& textures) {
  SurfaceSettings from = scene.surface;
  if (cue.texture) {
    put_texture(from, *cue.texture);
    from.line = cue.line;
  }
  const surface::Placement& place = floor.surface->placement();
  from.position += cue.shift.x() * place.t() + cue.shift.y() * place.b();
  auto made = build_surface(from, textures);
  if (!made) return made;
  made->material = floor.material;
  made->grounds = floor.grounds;
  made->reliefs = floor.reliefs;
  return made;
}

// Makes what the senses are given instead, where the scene's cues say so.
Result<void> add_cues(const Scene& scene, SceneSurface& floor, Textures& textures) {
  decltype(floor.instead) instead;
  for (const Cue cue : all_cues) {
    const CueSettings& settings = scene.cues[cue];
    SceneSurface made = floor;
    if (settings.moves_texture()) {
      auto other = other_floor(scene, floor, settings, textures);
      if (!other) return tl::unexpected(other.error());
      made = std::move(*other);
    }
    const bool is_blank = cue == Cue::picture && !settings.on;
    if (is_blank) {
      make_blank(made);
      for (SceneSurface& ground : made.grounds) make_blank(ground);
    }
    if (is_blank || settings.moves_texture())
      instead[std::size_t(cue)] = std::make_shared<const SceneSurface>(std::move(made));
  }
  floor.instead = std::move(instead);
  return {};
}

}  // namespace

const SceneSurface& given(const SceneSurface& floor, Cue cue) {
  const auto& instead = floor.instead[std::size_t(cue)];
  return instead ? *instead : floor;
}

std::vector<std::shared_ptr<const surface::Surface>> heard_textures(const SceneSurface& floor) {
  std::vector textures = {floor.surface};
  for (const Cue sound : {Cue::pen_sound, Cue::ball_sound})
    if (const SceneSurface& heard = given(floor, sound); &heard != &floor) textures.push_back(heard.surface);
  return textures;
}

int heard_texture(const SceneSurface& floor, Cue sound) {
  if (&given(floor, sound) == &floor) return 0;
  return sound == Cue::ball_sound && floor.instead[std::size_t(Cue::pen_sound)] ? 2 : 1;
}

Result<SceneSurface> make_surface(const Scene& scene) {
  if (auto fits = check_cost(scene, Use::shown); !fits) return tl::unexpected(fits.error());
  Textures textures(scene.allowed_memory);
  auto floor = build_surface(scene.surface, textures);
  if (!floor) return floor;
  for (const SurfaceSettings& ground : scene.grounds) {
    auto made = build_surface(ground, textures);
    if (!made) return made;
    floor->grounds.push_back(std::move(*made));
  }
  if (auto checked = check_contact_cost(scene, *floor); !checked) return tl::unexpected(checked.error());
  for (const BodySettings& body : scene.bodies) {
    auto made = make_reliefs(body, textures);
    if (!made) return tl::unexpected(made.error());
    floor->reliefs.push_back(std::move(*made));
  }
  if (!scene.cues.are_true())
    if (auto added = add_cues(scene, *floor, textures); !added) return tl::unexpected(added.error());
  return floor;
}

namespace {

// Segment count: `wanted`, fine enough for smooth rolling, rounded up to a multiple of `repeat`.
int pieces(int wanted, double repeat) {
  const int times = int(repeat);
  return times * ((wanted + times - 1) / times);
}

Result<surface::TriangleMesh> mesh_of(const BaseSettings& base, std::uint64_t allowed_memory) {
  const int around = pieces(64, base.repeat.x()), up = pieces(32, base.repeat.y());
  switch (base.shape) {
    case BaseSettings::Shape::cylinder:
      return surface::make_cylinder(base.radius, base.height, around, pieces(1, base.repeat.y()));
    case BaseSettings::Shape::sphere:
      return surface::make_sphere(base.radius, around, up);
    case BaseSettings::Shape::mesh:
      return surface::read_mesh(base.file, {surface::MeshUse::texture, allowed_memory});
    default:
      return surface::make_bowl(base.radius, around, up);
  }
}

}  // namespace

Result<surface::MeshPlacement> make_base(const BaseSettings& base, const Pose& pose,
                                         std::uint64_t allowed_memory) {
  auto mesh = mesh_of(base, allowed_memory);
  if (!mesh) return tl::unexpected(mesh.error());
  for (Vec2& uv : mesh->uvs) uv = uv.cwiseProduct(base.repeat);
  return surface::MeshPlacement::make(surface::moved(std::move(*mesh), pose),
                                      base.file.empty() ? "base" : base.file);
}

namespace {

constexpr double warn_above = 1e5, limit = 1e6;  // texels

double largest_ball(const Scene& scene) {
  double radius = 0;
  for (const BallSettings& ball : scene.balls) radius = std::max(radius, ball.radius);
  for (const BodySettings& body : scene.bodies)
    if (const auto* ball = std::get_if<contact::Sphere>(&body.body.shape))
      radius = std::max(radius, ball->radius);
  return radius;
}

}  // namespace

double covered_texels(const SceneSurface& relief, double radius) {
  const surface::Surface& surface = *relief.surface;
  if (!relief.curved || surface.is_flat()) return 0;
  const surface::Placement& texture = surface.placement();
  const double texel =
      texture.size_u() * texture.size_v() / (double(surface.width()) * double(surface.height()));
  return 2 * std::numbers::pi * radius * surface.max_depth() / texel;
}

Result<void> check_contact_cost(const Scene& scene, SceneSurface& floor) {
  const double radius = largest_ball(scene);
  for (std::size_t k = 0; k < floor.grounds.size(); ++k) {
    const double texels = covered_texels(floor.grounds[k], radius);
    if (texels < warn_above) continue;
    const Error error = with_where(
        scene.grounds[k].base->line,
        {"", fmt::format("a ball of radius {:g} m covers {:.2g} texels of this relief", radius, texels),
         fmt::format("the limit is {:g}: reduce repeat or depth, or use a coarser texture", limit)});
    if (texels > limit) return tl::unexpected(error);
    floor.notes.push_back("warning: physics steps will be slow: " + error.message());
  }
  return {};
}

}  // namespace intaglio::scene
