#include "evaluate/body_world.h"

namespace intaglio::evaluate {

namespace {

// Local to world.
Quat frame_of(const surface::Placement& place) {
  return Quat(Mat3((Mat3() << place.t(), place.b(), place.n()).finished()));
}

}  // namespace

Vec3 lowest_point(const contact::Shape& shape, const Pose& pose) {
  if (const auto* ball = std::get_if<contact::Sphere>(&shape))
    return pose.position - Vec3(0, 0, ball->radius);
  std::vector<Vec3> corners;
  if (const auto* box = std::get_if<contact::Box>(&shape)) {
    for (int k = 0; k < 8; ++k)
      corners.push_back(box->half.cwiseProduct(Vec3((k & 1) ? 1 : -1, (k & 2) ? 1 : -1, (k & 4) ? 1 : -1)));
  } else {
    corners = std::get<contact::ConvexHull>(shape).form->vertices;
  }
  Vec3 lowest = pose.to_world(corners.front());
  for (const Vec3& corner : corners)
    if (const Vec3 at = pose.to_world(corner); at.z() < lowest.z()) lowest = at;
  return lowest;
}

BodyWorld::BodyWorld(const Subject& subject, const Candidate& candidate, const contact::Shape& shape,
                     const Material& body)
    : BodyWorld(subject, candidate, shape, body, subject.surface(candidate).material) {}

BodyWorld::BodyWorld(const Subject& subject, const Candidate& candidate, const contact::Shape& shape,
                     const Material& body, const Material& floor)
    : subject_(subject),
      shape_(shape),
      place_(subject.surface(candidate).surface->placement()),
      is_relief_(candidate.representation == Representation::relief) {
  scene::Scene scene = subject.scene(candidate);
  rate_ = scene.physics.rate;
  const contact::MassProperties properties = contact::mass_properties(shape);
  mass_ = body.density * properties.volume;
  inertia_ = body.density * properties.inertia;
  if (candidate.mesh_cells > 0) {
    mesh_.emplace(subject.mesh(candidate), floor, shape, body, rate_);
    return;
  }
  scene.balls.clear();
  scene.bodies.clear();
  scene::SceneSurface surface = subject.surface(candidate);
  surface.material = floor;
  // Its start is above the surface; put() moves it.
  const Pose start{Vec3(0, 2 * subject.options().size, 0), Quat::Identity()};
  if (const auto* ball = std::get_if<contact::Sphere>(&shape)) {
    scene::BallSettings settings;
    settings.radius = ball->radius;
    settings.material = body;
    settings.position = start.position;
    scene.balls = {settings};
  } else {
    scene::BodySettings settings;
    settings.body.shape = shape;
    settings.body.material = body;
    settings.body.pose = start;
    scene.bodies = {settings};
  }
  world_.emplace(scene, surface, candidate.representation);
}

void BodyWorld::put(BodyState state) {
  if (!is_relief_) {
    const Vec3 lowest = lowest_point(shape_, state.pose);
    state.pose.position.z() -= subject_.reference().height(lowest.head<2>());
  }
  const BodyState at{
      {place_.to_world(state.pose.position), (frame_of(place_) * state.pose.orientation).normalized()},
      place_.direction_to_world(state.velocity),
      place_.direction_to_world(state.angular_velocity)};
  if (mesh_) return mesh_->put(at);
  world_->world().put(1, at.pose, at.velocity, at.angular_velocity);
}

void BodyWorld::step() {
  if (mesh_) return mesh_->step();
  world_->step();
}

BodyState BodyWorld::state() const {
  BodyState at;
  if (mesh_) {
    at = mesh_->state();
  } else {
    at = {world_->world().drawn_pose(1), world_->world().drawn_velocity(1),
          world_->world().angular_velocity(1)};
  }
  return {
      {place_.to_local(at.pose.position), (frame_of(place_).conjugate() * at.pose.orientation).normalized()},
      place_.direction_to_local(at.velocity),
      place_.direction_to_local(at.angular_velocity)};
}

BodyState BodyWorld::simulated() const {
  if (mesh_) return mesh_->state();
  return {world_->world().pose(1), world_->world().velocity(1), world_->world().angular_velocity(1)};
}

double BodyWorld::energy() const {
  const BodyState at = simulated();
  const Vec3 spin = at.pose.orientation.conjugate() * at.angular_velocity;
  return 0.5 * mass_ * at.velocity.squaredNorm() + 0.5 * spin.dot(inertia_ * spin) +
         mass_ * 9.81 * place_.to_local(at.pose.position).z();
}

}  // namespace intaglio::evaluate
