// One blow with a mallet on a body that hangs free: for hearing a model.
//
// Pure but for the synthesizer it makes. Positions and directions in the model's own frame, metres.
#pragma once

#include <memory>
#include <optional>

#include "intaglio/event.h"
#include "sound/modal_model.h"
#include "sound/synthesizer.h"

namespace intaglio::sound {

struct Mallet {
  Material material = *find_material("wood");
  double radius = 0.01;  // m: a ball
  double mass() const;   // kg
};

struct Strike {
  std::optional<Vec3> at;         // unset: default_strike_point()
  std::optional<Vec3> direction;  // of the push; unset: into the surface there
  std::optional<double> impulse;  // N s; unset: what the mallet gives at 1 m/s
  Mallet mallet;
};

// The nearest point of the model's surface, and its outward normal.
struct SurfacePoint {
  Vec3 point, normal;
};
SurfacePoint nearest_surface(const ModalModel& model, const Vec3& point);

// Where a body is struck when nobody says where: on the broad side of its bounding box (of equal ones the
// top, then the front), over a third of the way from the middle to the rim, away from every plane of
// symmetry, so that few modes have a node there. The body's geometry alone decides.
Vec3 default_strike_point(const ModalModel& model);

// The bodies, and the blow at `time`, for a Synthesizer or a LiveSound.
inline constexpr BodyId struck_body = 1, mallet_body = 2;
std::vector<SoundBody> strike_bodies(std::shared_ptr<const ModalModel> model, const Strike& strike);
ContactEvent strike_event(const ModalModel& model, const Strike& strike, double time);

}  // namespace intaglio::sound
