// The message between the senses: a contact between two bodies, with the time at which it happened.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "intaglio/vec.h"

namespace intaglio {

using BodyId = std::uint32_t;
inline constexpr BodyId floor_body = 0;
// Textured surfaces beside the floor are numbered from here, other bodies below.
inline constexpr BodyId first_surface_body = 1u << 20;
inline constexpr bool is_surface(BodyId id) {
  return id == floor_body || id >= first_surface_body;
}

// A place on one of a body's textures.
struct TexturePlace {
  int texture = 0;            // which of the body's, in the order in which they were given
  Vec2 uv = Vec2::Zero();     // 0..1
  Vec2 sweep = Vec2::Zero();  // m/s along u and v: how fast the contact moves over it
};

// A phase belongs to the pair of bodies, not to the point: `begin` for all points of its first step, then
// `persist`, and one `end`, with impulse 0, in the first step without contact.
enum class ContactPhase : std::uint8_t { begin, persist, end };

// One step of one contact between `body` and the textured surface of `other`, which may itself be a moving
// body. `other` may also be a body without a texture: then uv means nothing and both normals are the
// contact's. SI units, world frame. docs/library.md says how to make events from your own engine's contacts.
struct ContactEvent {
  // s, the end of the step that gave the impulse. World dates back an impact that it resolves a step late.
  double time = 0;
  BodyId body = 0;            // the moving body (ball, pen)
  BodyId other = floor_body;  // the textured body
  ContactPhase phase = ContactPhase::begin;
  Vec3 point = Vec3::Zero();  // m
  Vec2 uv = Vec2::Zero();     // where on the texture, 0..1
  int texture = 0;            // which of the textures of `other`; less than 0: none there
  // m/s, v_t along u and v; unset for a rectangle that does not move: its own frame and v_t give it.
  std::optional<Vec2> sweep;
  std::optional<TexturePlace> own;  // where on a texture of `body` itself, if it has one there
  Vec3 n_g = Vec3::UnitY();         // normal of the coarse geometry
  Vec3 n_s = Vec3::UnitY();         // normal sampled from the texture, or of the relief feature touched
  // m/s, along the coarse surface (without the part along n_g), relative to `other` at the point: how the
  // contact moves. World gives the velocity of the body's centre of mass, of a tumbling box as of a ball;
  // between two round bodies, that of the point between their centres.
  Vec3 v_t = Vec3::Zero();
  // m/s, along the coarse surface, what rotation adds to v_t at the body's own surface there: angular
  // velocity x (point - centre of mass). -v_t when it rolls; v_t + spin is the slip.
  Vec3 spin = Vec3::Zero();
  Vec3 impulse = Vec3::Zero();  // N s, on the body, over the step that ends at `time`
  double duration = 0;          // s, the length of that step; above 0
  // How long before `time` the surfaces met, s, 0..duration; not-a-number if they touched already, or if only
  // the step is known: then a `begin` sounds in the middle of its step.
  double touch_age = std::numeric_limits<double>::quiet_NaN();
  Pose body_pose;                  // of `body` at `time`
  std::optional<Pose> other_pose;  // of `other`, when that moves
};

}  // namespace intaglio
