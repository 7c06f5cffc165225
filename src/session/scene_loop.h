// The loop of a scene as offline and live sessions run it: bodies, the pen, and the contacts of both.
//
// A session owns the clock and the threads. It calls step() and emit_contacts() once a physics step, runs the
// servo that make_servo() gives it, and hands the servo's reports back. Every contact goes to one sink, in
// order of time: a recording and a synthesizer offline, sound and the window's marks live. Balls, bodies and
// the pen are numbered as in scene/world.h. One thread, physics'; the servo may run in another.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "haptics/pen.h"
#include "haptics/proxy.h"
#include "haptics/servo.h"
#include "intaglio/event.h"
#include "intaglio/representation.h"
#include "scene/world.h"

namespace intaglio::session {

// Several solids as one thing to touch: the pen meets the one that it is deepest in.
//
// The depth is the greatest of the parts' depths: continuous, so an energy made of it is, too; its gradient
// is that of the deepest part. Real-time; any thread.
class UnionSolid : public haptics::Solid {
 public:
  void add(std::unique_ptr<haptics::Solid> part) { parts_.push_back(std::move(part)); }

  haptics::Penetration at(const Vec3& p) const override;
  haptics::Penetration at(const Vec3& p, std::size_t part) const { return parts_[part]->at(p); }
  std::size_t deepest(const Vec3& p) const;

 private:
  std::vector<std::unique_ptr<haptics::Solid>> parts_;
};

// How the scene's pen is felt on a floor of that material. The scene has a pen.
haptics::ServoOptions pen_options(const scene::Scene& scene, const Material& floor);

using ContactSink = std::function<void(const ContactEvent&)>;

// The pen in a scene: the surfaces that it meets, the balls that it pushes, and its contacts.
class PenLink {
 public:
  // The scene has a pen. `felt`: how much of the textures the pen feels.
  PenLink(const scene::Scene& scene, const scene::SceneSurface& surface, Representation felt);

  // Meets the floor and all grounds; with the paper's planes, which are made of one surface, the floor only.
  // Where the scene's cues falsify touch, the hand gets the force of that servo and the report is of a true
  // contact (PenServo::set_contact).
  haptics::PenServo make_servo() const;
  // Gives the balls what the pen has pushed since the last call.
  void push_balls(const haptics::ServoReport& report, scene::SceneWorld& world);
  // Balls as they are drawn. `speed`: simulated seconds a second of the servo's clock; 0 while paused.
  haptics::SceneSnapshot snapshot(const scene::SceneWorld& world, double speed = 1) const;
  // Emits the pen's contact over the `duration` seconds that end at `time`, if it touches or has just let go.
  void emit_contact(const haptics::ServoReport& report, double time, double duration,
                    const ContactSink& sink);

 private:
  struct Ground {
    BodyId id;
    std::shared_ptr<const surface::Surface> surface;
    std::optional<surface::ReliefMesh> curved;
    double thickness;  // m
  };
  std::shared_ptr<const UnionSolid> union_of(const std::vector<Ground>& grounds) const;
  haptics::PenServo make_servo(const std::vector<Ground>& grounds,
                               const std::shared_ptr<const UnionSolid>& solid,
                               const haptics::ServoOptions& options) const;
  std::size_t touched_ground(const Vec3& proxy) const;
  void place(const Ground& ground, const Vec3& velocity, ContactEvent& event) const;
  ContactEvent event(const haptics::ServoReport& report, std::size_t ground, ContactPhase phase, double time,
                     double duration) const;

  BodyId id_;
  std::vector<double> ball_radii_;  // m, of those that the pen can meet
  double length_;                   // m
  Vec3 up_;                         // unit, along the pen
  haptics::ServoOptions options_;
  std::vector<Ground> grounds_;              // the floor, then the scene's grounds
  std::shared_ptr<const UnionSolid> solid_;  // of all grounds; null: the floor only
  scene::CueSettings touch_;                 // what the hand is given
  std::shared_ptr<const surface::Surface> felt_floor_;
  std::vector<Vec3> pushed_;            // N s on each ball, already handed to the world
  std::optional<std::size_t> touched_;  // the ground that the pen touched last
};

// Input of a step: keys, and a body that a hand drags.
struct StepInput {
  unsigned keys = 0;            // left_key, right_key of scene/world.h
  BodyId dragged = floor_body;  // the floor: none
  Vec3 grip = Vec3::Zero();     // where it is held, in the frame of the body as drawn
  Vec3 pull_to = Vec3::Zero();  // m, where that point is wanted
};

class SceneLoop {
 public:
  // `moved`, `felt`: how much of the textures bodies meet and the pen feels. Bodies move on what the scene's
  // cues say; contacts are reported at the place on the true floor.
  SceneLoop(const scene::Scene& scene, const scene::SceneSurface& surface, Representation moved,
            Representation felt, ContactSink sink);

  scene::SceneWorld& world() { return world_; }
  const scene::SceneWorld& world() const { return world_; }
  double time() const { return world_.world().time(); }
  // Absent when the scene has none.
  PenLink* pen() { return pen_ ? &*pen_ : nullptr; }
  haptics::SceneSnapshot snapshot(double speed = 1) const { return pen_->snapshot(world_, speed); }

  // One physics step. `report`: the pen's newest, null without one.
  void step(const haptics::ServoReport* report, const StepInput& input = {});
  // The bodies' contacts of that step.
  void emit_contacts() const;
  // The pen's contact; in a session whose servo keeps up, once a tick, else once a step.
  void emit_pen(const haptics::ServoReport& report, double time, double duration) {
    pen_->emit_contact(report, time, duration, sink_);
  }

 private:
  void drag(const StepInput& input);

  double step_;                   // s
  Vec2 uv_shift_ = Vec2::Zero();  // of the bodies' texture over the floor
  scene::SceneWorld world_;
  std::optional<PenLink> pen_;
  ContactSink sink_;
};

}  // namespace intaglio::session
