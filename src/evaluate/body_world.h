// One free body in the world of a candidate, whichever engine moves it: a ball, a box, or a hull whose frame
// is that of its principal axes.
//
// States are in local coordinates of the surface (z up, out of it), those of ReferenceBody. Over flat floors
// and normal maps bodies are drawn on the base plane: put() sets a body down by the height of the relief
// under its lowest point, and state() says where it is drawn. One thread at a time; deterministic.
#pragma once

#include <optional>

#include "evaluate/subject.h"
#include "scene/world.h"

namespace intaglio::evaluate {

class BodyWorld {
 public:
  BodyWorld(const Subject& subject, const Candidate& candidate, const contact::Shape& shape,
            const Material& body, const Material& floor);
  // The floor is of the texture's material.
  BodyWorld(const Subject& subject, const Candidate& candidate, const contact::Shape& shape,
            const Material& body);

  // At the state of a body on the reference.
  void put(BodyState state);
  void step();
  BodyState state() const;  // as drawn
  // Kinetic and potential energy where the body is simulated, J.
  double energy() const;
  double rate() const { return rate_; }  // Hz

 private:
  BodyState simulated() const;

  const Subject& subject_;
  contact::Shape shape_;
  surface::Placement place_;
  bool is_relief_;
  double rate_, mass_;
  Mat3 inertia_;  // body frame
  std::optional<MeshWorld> mesh_;
  std::optional<scene::SceneWorld> world_;
};

// The lowest point of a body in that pose; local.
Vec3 lowest_point(const contact::Shape& shape, const Pose& pose);

}  // namespace intaglio::evaluate
