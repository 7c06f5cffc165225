#include "intaglio/session/covered_texels.h"

#include <algorithm>
#include <numbers>
#include <variant>

#include "intaglio/core/nested_error.h"

namespace intaglio::session {

namespace {

constexpr double slow = 1e5, most = 1e6;  // texels

double largest_ball(const Scene& scene) {
  double radius = 0;
  for (const BallScene& ball : scene.balls) radius = std::max(radius, ball.radius);
  for (const BodyScene& body : scene.bodies)
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

Result<void> check_covered_texels(const Scene& scene, SceneSurface& floor) {
  const double radius = largest_ball(scene);
  for (std::size_t k = 0; k < floor.grounds.size(); ++k) {
    const double texels = covered_texels(floor.grounds[k], radius);
    if (texels < slow) continue;
    const Error error = with_where(
        scene.grounds[k].base->line,
        {"", fmt::format("a ball of {:g} m lies over {:.2g} texels of this relief", radius, texels),
         fmt::format("more than {:g} take too long: give a smaller repeat or depth, or a coarser texture",
                     most)});
    if (texels > most) return tl::unexpected(error);
    floor.notes.push_back("warning: steps take long: " + error.message());
  }
  return {};
}

}  // namespace intaglio::session
