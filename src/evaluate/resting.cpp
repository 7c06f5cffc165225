#include "evaluate/resting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/bootstrap.h"
#include "core/portable_math.h"
#include "evaluate/body_world.h"

namespace intaglio::evaluate {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double span_seconds = 0.5, settle_seconds = 0.15;
constexpr int spans = 6;

// How far a body moves in a span.
struct Way {
  double metres = 0, turn = 0;  // rad
};
Way way_between(const Pose& a, const Pose& b) {
  const double half = std::abs((a.orientation.conjugate() * b.orientation).normalized().w());
  return {(b.position - a.position).norm(), 2 * elementary::acos(std::min(1.0, half))};
}

// Runs until the body hardly moves or 3 s are over; the way of the last span.
Way run_to_rest(BodyWorld& world) {
  Way way;
  for (int span = 0; span < spans; ++span) {
    const Pose before = world.state().pose;
    for (std::int64_t step = 0; step < std::int64_t(span_seconds * world.rate()); ++step) world.step();
    way = way_between(before, world.state().pose);
    if (way.metres < 3e-4 && way.turn < 5e-3) break;
  }
  return way;
}

// Where the body lies compared with where it would on the reference.
void compare_ball(const Subject& subject, const BodyState& state, RestOfBody& out) {
  const double radius = subject.ball_radius();
  const Vec3& at = state.pose.position;
  out.height_mm = 1000 * (at.z() - radius - subject.reference().rest_on(at.head<2>(), radius).z);
  const auto near = subject.reference().nearest(at, radius);
  out.overlap_mm = near.empty() ? 0 : std::max(0.0, 1000 * (radius - near.front().distance));
  if (at.z() < subject.reference().height(at.head<2>())) out.overlap_mm = 1000 * radius;
  out.tilt = unknown;
}

void compare_body(ReferenceBody& truth, const BodyState& state, RestOfBody& out) {
  const double gap = truth.gap_at(state.pose, 1e-4);
  out.overlap_mm = std::isfinite(gap) ? std::max(0.0, -1000 * gap) : 0;
  truth.put({state.pose, Vec3::Zero(), Vec3::Zero()});
  for (int k = 0; k < int(settle_seconds * reference_rate); ++k) truth.step();
  const Pose& settled = truth.state().pose;
  out.height_mm = 1000 * (state.pose.position.z() - settled.position.z());
  const double half = std::abs((state.pose.orientation.conjugate() * settled.orientation).normalized().w());
  out.tilt = 2 * elementary::acos(std::min(1.0, half)) * 180 / std::numbers::pi;
}

}  // namespace

std::vector<Drop> plan_drops(std::uint64_t seed, int count, double size) {
  Random random(seed ^ 0x64726f70ull);
  std::vector<Drop> drops;
  for (int k = 0; k < count; ++k) {
    Drop drop;
    drop.kind = std::array{BodyKind::ball, BodyKind::box, BodyKind::hull}[std::size_t(k % 3)];
    const double x = random.uniform(0.3, 0.7), y = random.uniform(0.3, 0.7), z = random.uniform(0.07, 0.12);
    Vec3 turn;
    for (int axis = 0; axis < 3; ++axis) turn[axis] = random.uniform(-1.5, 1.5);
    drop.start.pose = {size * Vec3(x, y, z), rotation(turn)};
    drops.push_back(drop);
  }
  return drops;
}

std::vector<RestOfBody> rests(const Subject& subject, const Candidate& candidate,
                              const std::vector<Drop>& drops) {
  const double size = subject.options().size;
  std::vector<RestOfBody> out(drops.size());
  for (const BodyKind kind : {BodyKind::ball, BodyKind::box, BodyKind::hull}) {
    const contact::Shape shape = body_shape(kind, size);
    BodyWorld world(subject, candidate, shape, body_material());
    std::optional<ReferenceBody> truth;
    if (kind != BodyKind::ball)
      truth.emplace(subject.reference(), body_form(shape), body_material(),
                    subject.surface(candidate).material);
    for (std::size_t k = 0; k < drops.size(); ++k) {
      if (drops[k].kind != kind) continue;
      world.put(drops[k].start);
      const Way way = run_to_rest(world);
      const BodyState state = world.state();
      RestOfBody& rest = out[k];
      rest = {kind, false, unknown, unknown, unknown, unknown};
      const Vec3& at = state.pose.position;
      const bool is_inside = at.x() > 0 && at.y() > 0 && at.x() < size && at.y() < size && at.z() > -size;
      rest.at_rest = is_inside && way.metres < 0.005 * span_seconds && way.turn < 0.1 * span_seconds;
      if (!rest.at_rest) continue;
      rest.creep_mm = 1000 * way.metres;
      if (truth) {
        compare_body(*truth, state, rest);
      } else {
        compare_ball(subject, state, rest);
      }
    }
  }
  return out;
}

RestStatistics rest_statistics(const std::vector<RestOfBody>& rests) {
  RestStatistics out;
  out.bodies = rests.size();
  std::vector<double> height, tilt, sunk, creep;
  for (const RestOfBody& rest : rests) {
    if (!rest.at_rest) continue;
    height.push_back(std::abs(rest.height_mm));
    if (std::isfinite(rest.tilt)) tilt.push_back(rest.tilt);
    sunk.push_back(rest.overlap_mm > 1 ? 1 : 0);
    creep.push_back(rest.creep_mm);
  }
  out.at_rest = rests.empty() ? unknown : double(height.size()) / double(rests.size());
  out.height_mm = mean(height);
  out.tilt = mean(tilt);
  out.sunk = mean(sunk);
  out.creep_mm = mean(creep);
  return out;
}

}  // namespace intaglio::evaluate
