// The brick by its few numbers: brick_running with those put in.
#include "intaglio/surface/brick.h"

#include "intaglio/surface/builtin/builtin.h"

namespace intaglio::surface {

TextureImages make_brick(const BrickRecipe& brick) {
  BuiltinRecipe recipe = find_builtin("brick_running").value();
  recipe.seed = brick.seed;
  recipe.about.depth_fraction = brick.depth_fraction;
  recipe.layout.columns = brick.columns;
  recipe.layout.rows = brick.rows;
  recipe.layout.joint = brick.joint;
  recipe.layout.corner = brick.corner_radius;
  recipe.profile.bevel = brick.bevel;
  return make_texture(recipe, brick.size);
}

}  // namespace intaglio::surface
