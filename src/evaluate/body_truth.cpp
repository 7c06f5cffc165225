#include "evaluate/body_truth.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "contact/surface_contacts.h"
#include "core/portable_math.h"
#include "evaluate/body_world.h"

namespace intaglio::evaluate {

namespace {

constexpr double to_degrees = 180 / std::numbers::pi;
constexpr double restart_after = 0.1;   // s
constexpr double normals_every = 0.05;  // s

double angle_of(const Vec3& a, const Vec3& b) {
  return elementary::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * to_degrees;
}

double turn_between(const Quat& a, const Quat& b) {
  const double half = std::abs((a.conjugate() * b).normalized().w());
  return 2 * elementary::acos(std::min(1.0, half)) * to_degrees;
}

contact::ConvexHull irregular_hull(double size) {
  Random random(11);
  std::vector<Vec3> points;
  for (int k = 0; k < 12; ++k) {
    Vec3 direction;
    for (int axis = 0; axis < 3; ++axis) direction[axis] = random.normal();
    points.push_back(size * 0.045 * direction.normalized().cwiseProduct(Vec3(1.1, 0.9, 0.7)));
  }
  // Into the frame of the principal axes.
  const contact::MassProperties mass = contact::mass_properties(make_hull(points).value());
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(mass.inertia);
  Mat3 turn = axes.eigenvectors();
  if (turn.determinant() < 0) turn.col(0) *= -1;
  for (Vec3& point : points) point = turn.transpose() * (point - mass.centre);
  return make_hull(points).value();
}

}  // namespace

contact::Shape body_shape(BodyKind kind, double size) {
  switch (kind) {
    case BodyKind::ball:
      return contact::Sphere{0.04 * size};
    case BodyKind::box:
      return contact::Box{size * Vec3(0.04, 0.03, 0.025)};
    default:
      return irregular_hull(size);
  }
}

ConvexForm body_form(const contact::Shape& shape) {
  if (const auto* box = std::get_if<contact::Box>(&shape)) return box_form(box->half);
  return hull_form(std::get<contact::ConvexHull>(shape));
}

Material body_material() {
  return *find_material("plastic");
}

ReferenceThrow reference_throw(const Subject& subject, const ThrowOptions& options) {
  const Candidate& ours = candidates()[std::size_t(Kind::relief)];
  const contact::Shape shape = body_shape(options.kind, subject.options().size);
  const surface::Placement& place = subject.surface(ours).surface->placement();
  ReferenceBody body(subject.reference(), body_form(shape), body_material(), subject.surface(ours).material);
  body.put(options.start);
  ReferenceThrow out{.kind = options.kind, .states = {options.start}, .touching = {false}};
  for (std::int64_t k = 0; k < std::int64_t(options.seconds * reference_rate); ++k) {
    body.step();
    if (!place.covers(body.state().pose.position, -contact::bounding_radius(shape))) break;
    out.states.push_back(body.state());
    out.touching.push_back(body.touches());
  }
  return out;
}

ThrowError throw_error(const Subject& subject, const Candidate& candidate, const ReferenceThrow& reference) {
  const contact::Shape shape = body_shape(reference.kind, subject.options().size);
  BodyWorld world(subject, candidate, shape, body_material());
  const auto ratio = std::size_t(std::lround(reference_rate / world.rate()));
  const auto every = std::size_t(std::lround(restart_after * world.rate()));
  double place = 0, height = 0, turn = 0;
  std::size_t count = 0;
  for (std::size_t from = 0; from + every * ratio < reference.states.size(); from += every * ratio) {
    world.put(reference.states[from]);
    for (std::size_t k = 0; k < every; ++k) world.step();
    const Pose at = world.state().pose, wanted = reference.states[from + every * ratio].pose;
    const Vec3 off = at.position - wanted.position;
    place += off.head<2>().squaredNorm();
    height += off.z() * off.z();
    turn += std::pow(turn_between(at.orientation, wanted.orientation), 2);
    ++count;
  }
  const auto root = [&](double sum) { return std::sqrt(sum / double(count)); };
  const ReferenceBody truth(subject.reference(), body_form(shape), body_material(),
                            subject.surface(candidate).material);
  std::vector<Pose> poses;
  std::vector<std::vector<Vec3>> normals;
  const auto step = std::size_t(normals_every * reference_rate);
  for (std::size_t k = step; k < reference.states.size(); k += step) {
    if (!reference.touching[k]) continue;
    poses.push_back(reference.states[k].pose);
    normals.push_back(truth.normals_at(poses.back(), 5e-4));
  }
  return {1000 * root(place), 1000 * root(height), root(turn),
          contact_normal_error(subject, candidate, shape, poses, normals)};
}

ThrowError half_rate_error(const Subject& subject, const ReferenceThrow& reference) {
  const contact::Shape shape = body_shape(reference.kind, subject.options().size);
  ReferenceBody body(subject.reference(), body_form(shape), body_material(),
                     subject.surface(candidates()[std::size_t(Kind::relief)]).material, reference_rate / 2);
  const auto steps = std::size_t(restart_after * reference_rate);
  double place = 0, turn = 0;
  std::size_t count = 0;
  for (std::size_t from = 0; from + steps < reference.states.size(); from += steps) {
    body.put(reference.states[from]);
    for (std::size_t k = 0; k < steps / 2; ++k) body.step();
    const Pose &at = body.state().pose, &wanted = reference.states[from + steps].pose;
    place += (at.position - wanted.position).squaredNorm();
    turn += std::pow(turn_between(at.orientation, wanted.orientation), 2);
    ++count;
  }
  ThrowError out;
  out.place_mm = 1000 * std::sqrt(place / double(count));
  out.turn = std::sqrt(turn / double(count));
  return out;
}

double contact_normal_error(const Subject& subject, const Candidate& candidate, const contact::Shape& shape,
                            const std::vector<Pose>& poses, const std::vector<std::vector<Vec3>>& normals) {
  const scene::SceneSurface& made = subject.surface(candidate);
  const surface::Surface& surface = *made.surface;
  const surface::Placement& place = surface.placement();
  const Quat frame(Mat3((Mat3() << place.t(), place.b(), place.n()).finished()));
  std::optional<MeshWorld> mesh;
  if (candidate.mesh_cells > 0)
    mesh.emplace(subject.mesh(candidate), made.material, shape, body_material(), 480);
  // Normal maps by the paper and flat floors know the plane only.
  const bool is_plane = candidate.kind == Kind::flat || candidate.kind == Kind::normal_paper;
  const double margin = 0.02 * contact::bounding_radius(shape);
  const auto normal_at = [&](const Pose& local) -> std::optional<Vec3> {
    Vec3 centre = local.position;
    if (is_plane) centre.z() -= lowest_point(shape, local).z();
    const Pose pose{place.to_world(centre), (frame * local.orientation).normalized()};
    if (mesh) {
      mesh->put({pose, Vec3::Zero(), Vec3::Zero()});
      const auto found = mesh->normals();
      if (found.empty()) return std::nullopt;
      return place.direction_to_local(found.front());
    }
    const contact::ContactSet found =
        candidate.kind == Kind::flat           ? contact::flat_contacts(surface, shape, pose, margin)
        : candidate.kind == Kind::normal_paper ? contact::normal_map_contacts(surface, shape, pose, margin)
        : candidate.kind == Kind::relief_paper ? contact::directional_contacts(surface, shape, pose, margin)
                                               : contact::relief_contacts(surface, shape, pose, margin);
    if (found.count == 0) return std::nullopt;
    return place.direction_to_local(found.points[0].normal);
  };
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (normals[k].empty()) continue;
    double off = 90;
    if (const auto normal = normal_at(poses[k]))
      for (const Vec3& true_normal : normals[k]) off = std::min(off, angle_of(*normal, true_normal));
    sum += off;
    ++count;
  }
  return count > 0 ? sum / double(count) : std::numeric_limits<double>::quiet_NaN();
}

namespace {

// The rise of an energy that is given after every step.
template <class Body>
EnergyRise rise_of(Body& body, double kinetic, double seconds, double rate) {
  EnergyRise out;
  double least = body.energy();
  for (std::int64_t k = 0; k < std::int64_t(seconds * rate); ++k) {
    body.step();
    const double now = body.energy();
    least = std::min(least, now);
    out.gained_j = std::max(out.gained_j, now - least);
  }
  out.share = kinetic > 0 ? out.gained_j / kinetic : std::numeric_limits<double>::quiet_NaN();
  return out;
}

Material without_rolling_resistance(Material material) {
  material.rolling_resistance = 0;
  return material;
}

double kinetic_energy(const BodyState& state, double radius) {
  const double mass = body_material().density * 4.0 / 3 * std::numbers::pi * radius * radius * radius;
  return 0.5 * mass * state.velocity.squaredNorm() +
         0.2 * mass * radius * radius * state.angular_velocity.squaredNorm();
}

}  // namespace

EnergyRise energy_rise(const Subject& subject, const Candidate& candidate, const BodyState& start,
                       double seconds) {
  const double radius = subject.ball_radius();
  BodyWorld world(subject, candidate, contact::Sphere{radius}, without_rolling_resistance(body_material()),
                  without_rolling_resistance(subject.surface(candidate).material));
  world.put(start);
  return rise_of(world, kinetic_energy(start, radius), seconds, world.rate());
}

EnergyRise reference_energy_rise(const Subject& subject, const BodyState& start, double seconds) {
  const double radius = subject.ball_radius();
  const Candidate& ours = candidates()[std::size_t(Kind::relief)];
  ReferenceBall ball(subject.reference(), radius, without_rolling_resistance(body_material()),
                     without_rolling_resistance(subject.surface(ours).material));
  ball.put(start);
  return rise_of(ball, kinetic_energy(start, radius), seconds, reference_rate);
}

}  // namespace intaglio::evaluate
