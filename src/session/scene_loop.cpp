#include "session/scene_loop.h"

#include <algorithm>
#include <cmath>

#include "intaglio/vec.h"

namespace intaglio::session {

haptics::Penetration UnionSolid::at(const Vec3& p) const {
  haptics::Penetration deepest{-1e9, -Vec3::UnitY()};
  for (const auto& part : parts_)
    if (const haptics::Penetration here = part->at(p); here.depth > deepest.depth) deepest = here;
  return deepest;
}

std::size_t UnionSolid::deepest(const Vec3& p) const {
  std::size_t deepest = 0;
  for (std::size_t k = 1; k < parts_.size(); ++k)
    if (at(p, k).depth > at(p, deepest).depth) deepest = k;
  return deepest;
}

haptics::ServoOptions pen_options(const scene::Scene& scene, const Material& floor) {
  const scene::PenSettings& pen = *scene.pen;
  haptics::ServoOptions options;
  options.representation = scene.surface.representation;
  options.method = pen.method;
  options.spring = pen.spring;
  options.friction = std::sqrt(pen.material.friction * floor.friction);
  options.passivity = pen.method == haptics::HapticMethod::potential;
  options.limits = pen.limits;
  options.workspace = pen.workspace;
  options.pen.length = pen.length;
  options.pen.radius = pen.radius;
  options.pen.tip_radius = pen.tip_radius.value_or(0.001 * pen.workspace.scale);
  options.spring.stiffness = haptics::felt_stiffness(floor, options.pen.tip_radius, pen.spring.stiffness);
  options.pen.grip = 0.4 * pen.length;
  options.pen.direction = pen.direction;
  options.thickness = scene.surface.thickness;
  options.rate = pen.device.rate;
  return options;
}

PenLink::PenLink(const scene::Scene& scene, const scene::SceneSurface& surface, Representation felt)
    : id_(scene.pen_id()),
      length_(scene.pen->length),
      up_(scene.pen->direction.normalized()),
      options_(pen_options(scene, surface.material)) {
  options_.representation = felt;
  for (const scene::BallSettings& ball : scene.balls)
    if (ball_radii_.size() < haptics::max_balls) ball_radii_.push_back(ball.radius);
  pushed_.assign(ball_radii_.size(), Vec3::Zero());
  grounds_.push_back({floor_body, surface.surface, std::nullopt, scene.surface.thickness});
  touch_ = scene.cues.touch;
  felt_floor_ = scene::given(surface, scene::Cue::touch).surface;
  if (surface.grounds.empty() || options_.method == haptics::HapticMethod::plane) return;
  for (std::size_t k = 0; k < surface.grounds.size(); ++k)
    grounds_.push_back({BodyId(first_surface_body + k), surface.grounds[k].surface, surface.grounds[k].curved,
                        scene.grounds[k].thickness});
  solid_ = union_of(grounds_);
}

std::shared_ptr<const UnionSolid> PenLink::union_of(const std::vector<Ground>& grounds) const {
  auto solid = std::make_shared<UnionSolid>();
  for (const Ground& ground : grounds) {
    const haptics::SolidOptions touch{options_.representation, 2 * options_.pen.tip_radius, ground.thickness};
    if (ground.curved) {
      solid->add(std::make_unique<haptics::TexturedMesh>(ground.surface, ground.curved->base(),
                                                         ground.thickness, touch));
    } else {
      solid->add(std::make_unique<haptics::TexturedSlab>(ground.surface, touch));
    }
  }
  return solid;
}

haptics::PenServo PenLink::make_servo(const std::vector<Ground>& grounds,
                                      const std::shared_ptr<const UnionSolid>& solid,
                                      const haptics::ServoOptions& options) const {
  if (!solid) return {grounds[0].surface, options};
  return {grounds[0].surface, solid, options};
}

haptics::PenServo PenLink::make_servo() const {
  haptics::PenServo contact = make_servo(grounds_, solid_, options_);
  if (touch_.is_true()) return contact;
  std::vector<Ground> grounds = grounds_;
  grounds[0].surface = felt_floor_;
  haptics::ServoOptions options = options_;
  options.delay = touch_.delay;
  options.displays = touch_.on;
  haptics::PenServo felt = make_servo(grounds, solid_ ? union_of(grounds) : nullptr, options);
  felt.set_contact(std::move(contact));
  return felt;
}

void PenLink::push_balls(const haptics::ServoReport& report, scene::SceneWorld& world) {
  // Through the centre: the pen meets a ball along the line from the ball's centre to its own axis.
  for (std::size_t k = 0; k < pushed_.size(); ++k) {
    const Vec3& sum = report.ball_impulse[k];
    if (sum != pushed_[k]) world.world().push(world.ball(k), sum - pushed_[k]);
    pushed_[k] = sum;
  }
}

haptics::SceneSnapshot PenLink::snapshot(const scene::SceneWorld& world, double speed) const {
  haptics::SceneSnapshot scene;
  scene.time = world.world().time();
  scene.ball_count = ball_radii_.size();
  for (std::size_t k = 0; k < ball_radii_.size(); ++k)
    scene.balls[k] = {world.pose(k).position, speed * world.world().drawn_velocity(world.ball(k)),
                      ball_radii_[k]};
  return scene;
}

// The ground on which the proxy lies. In a crease it lies on two: the pen goes on touching the one that it
// touched until another is more than twice as deep, so that a contact does not flicker between them.
std::size_t PenLink::touched_ground(const Vec3& proxy) const {
  if (!solid_) return 0;
  const std::size_t deepest = solid_->deepest(proxy);
  const bool stays = touched_ && 2 * solid_->at(proxy, *touched_).depth >= solid_->at(proxy, deepest).depth;
  return stays ? *touched_ : deepest;
}

// Where on the ground's texture the event's point is, and how it moves over it at that velocity.
void PenLink::place(const Ground& ground, const Vec3& velocity, ContactEvent& event) const {
  const bool flat = options_.representation == Representation::flat;
  if (!ground.curved) {
    const surface::Placement& place = ground.surface->placement();
    event.uv = place.uv(place.to_local(event.point));
    event.n_g = place.n();
    event.n_s = flat ? event.n_g : ground.surface->world_normal(event.uv);
    event.n_s += Vec3::Zero();  // logs have no negative zeros
  } else if (const auto under = ground.curved->base().closest(event.point, ground.thickness)) {
    event.uv = under->uv;
    event.sweep = ground.curved->sweep(*under, Quat::Identity()) * velocity;
    event.n_g = under->n;
    event.n_s = flat ? under->n : under->direction_to_world(ground.surface->normal(under->uv));
  } else {  // beyond the rim of the base
    event.texture = -1;
    event.n_g = event.n_s = up_;
  }
  event.v_t = velocity - velocity.dot(event.n_g) * event.n_g;
}

ContactEvent PenLink::event(const haptics::ServoReport& report, std::size_t ground, ContactPhase phase,
                            double time, double duration) const {
  ContactEvent event;
  event.time = time;
  event.body = id_;
  event.other = grounds_[ground].id;
  event.phase = phase;
  event.point = report.proxy;
  place(grounds_[ground], report.velocity, event);
  event.duration = duration;
  // Where the pen crosses over to another ground, that one has the force.
  if (phase != ContactPhase::end || !report.touching) event.impulse = report.force * duration;
  event.body_pose = {report.proxy + 0.5 * length_ * up_, rotation_onto(Vec3::UnitY(), up_)};
  return event;
}

void PenLink::emit_contact(const haptics::ServoReport& report, double time, double duration,
                           const ContactSink& sink) {
  std::optional<std::size_t> now;
  if (report.touching) now = touched_ground(report.proxy);
  if (touched_ && now != touched_) sink(event(report, *touched_, ContactPhase::end, time, duration));
  if (now)
    sink(event(report, *now, now == touched_ ? ContactPhase::persist : ContactPhase::begin, time, duration));
  touched_ = now;
}

SceneLoop::SceneLoop(const scene::Scene& scene, const scene::SceneSurface& surface, Representation moved,
                     Representation felt, ContactSink sink)
    : step_(1.0 / scene.physics.rate),
      uv_shift_(scene.cues.ball_motion.shift.cwiseQuotient(surface.surface->placement().size())),
      world_(scene, scene::given(surface, scene::Cue::ball_motion),
             scene.cues.ball_motion.on ? moved : Representation::flat),
      sink_(std::move(sink)) {
  if (scene.pen) pen_.emplace(scene, surface, felt);
}

void SceneLoop::step(const haptics::ServoReport* report, const StepInput& input) {
  if (pen_ && report != nullptr) pen_->push_balls(*report, world_);
  drag(input);
  world_.step(input.keys);
}

void SceneLoop::emit_contacts() const {
  for (const ContactEvent& event : world_.world().events()) {
    if (uv_shift_ == Vec2::Zero() || event.other != floor_body || event.texture < 0) {
      sink_(event);
      continue;
    }
    ContactEvent placed = event;
    placed.uv += uv_shift_;
    sink_(placed);
  }
}

// A spring from the held point to where it is wanted, no stronger than 60 times the body's weight:
//
//     m x'' = m w^2 (target - x) - 2 m w x'
//
// is critically damped for a body held at its centre. Held elsewhere a body turns, too; its effective mass at
// the grip is smaller, (1/m + |r x n|^2 / I)^-1, and the spring overdamped. w = 25/s reaches the target in
// about 40 ms; explicit steps of 1/480 s have w dt = 0.05, far from the limit of stability at 2.
void SceneLoop::drag(const StepInput& input) {
  if (!world_.is_free(input.dragged)) return;
  dynamics::World& world = world_.world();
  constexpr double omega = 25;  // rad/s
  const double mass = world_.mass(input.dragged);
  const Pose pose = world.drawn_pose(input.dragged);
  const Vec3 point = pose.to_world(input.grip);
  const Vec3 velocity = world.drawn_velocity(input.dragged) +
                        world.angular_velocity(input.dragged).cross(point - pose.position);
  Vec3 force = mass * (omega * omega * (input.pull_to - point) - 2 * omega * velocity);
  const double most = 60 * mass * 9.81;
  if (force.norm() > most) force *= most / force.norm();
  world.push(input.dragged, force * step_, point);
}

}  // namespace intaglio::session
