// What is under the mouse: a body, or a place of the floor. Pure.
#pragma once

#include <optional>
#include <span>

#include "intaglio/session/scene.h"
#include "intaglio/surface/mesh/triangle_mesh.h"
#include "intaglio/surface/surface.h"

namespace intaglio::window {

struct Picked {
  BodyId body = floor_body;   // the floor: none
  Vec3 point = Vec3::Zero();  // where the ray meets it, world
  double distance = 0;        // m along the ray
};

// The nearest body on the ray (`direction` unit). Balls exactly; other bodies by the balls or boxes that they
// are made of.
std::optional<Picked> pick_body(const session::Scene& scene, std::span<const Pose> poses, const Vec3& origin,
                                const Vec3& direction);

// Where the ray meets the floor's relief, or, beside the rectangle, its base plane.
std::optional<Vec3> pick_floor(const surface::Surface& floor, bool has_relief, const Vec3& origin,
                               const Vec3& direction);

// Where the ray meets the front of a curved base, with the normal there.
struct PickedBase {
  Vec3 point, normal;
};
std::optional<PickedBase> pick_base(const surface::TriangleMesh& base, const Vec3& origin,
                                    const Vec3& direction);

}  // namespace intaglio::window
