#include "evaluate/reference_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace intaglio::evaluate {

namespace {

constexpr double edge_step = 0.004;        // m, at most, between points on an edge
constexpr std::size_t most_contacts = 40;  // the nearest ones
constexpr double same_gap = 1e-9;          // m

// The gap between a point and the relief, along the relief's normal: the plane that touches the relief below
// the point, twice refined.
struct PointGap {
  double gap;
  Vec3 normal;
};
PointGap point_gap(const Reference& truth, const Vec3& p) {
  Vec2 q = p.head<2>();
  PointGap out{};
  for (int k = 0; k < 2; ++k) {
    const Vec2 s = truth.slope(q);
    out.normal = Vec3(-s.x(), -s.y(), 1).normalized();
    out.gap = out.normal.dot(p - Vec3(q.x(), q.y(), truth.height(q)));
    q = p.head<2>() - out.gap * out.normal.head<2>();
  }
  return out;
}

double signed_distance(const ConvexForm& form, const Vec3& p, const ConvexForm::Face* but) {
  double most = -std::numeric_limits<double>::infinity();
  for (const ConvexForm::Face& face : form.faces)
    if (&face != but) most = std::max(most, face.normal.dot(p) - face.offset);
  return most;
}

}  // namespace

ConvexForm box_form(const Vec3& half) {
  ConvexForm out;
  for (int k = 0; k < 8; ++k)
    out.corners.push_back(half.cwiseProduct(Vec3((k & 1) ? 1 : -1, (k & 2) ? 1 : -1, (k & 4) ? 1 : -1)));
  for (int k = 0; k < 8; ++k)
    for (const int bit : {1, 2, 4})
      if ((k & bit) == 0) out.edges.emplace_back(k, k | bit);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      ConvexForm::Face face{sign * Vec3::Unit(axis), half[axis], {}};
      for (int k = 0; k < 8; ++k)
        if (face.normal.dot(out.corners[std::size_t(k)]) > 0) face.corners.push_back(k);
      out.faces.push_back(std::move(face));
    }
  }
  out.volume = 8 * half.prod();
  const Vec3 square = half.cwiseProduct(half);
  out.inertia = (out.volume / 3 * (Vec3::Constant(square.sum()) - square)).asDiagonal();
  out.radius = half.norm();
  return out;
}

ConvexForm hull_form(const contact::ConvexHull& hull) {
  ConvexForm out;
  const Polyhedron& form = *hull.form;
  out.corners = form.vertices;
  for (const Polyhedron::Edge& edge : form.edges) out.edges.emplace_back(edge.a, edge.b);
  for (const Polyhedron::Face& face : form.faces)
    out.faces.push_back({face.normal,
                         face.offset,
                         {form.loop.begin() + face.first, form.loop.begin() + face.first + face.count}});
  const contact::MassProperties mass = contact::mass_properties(hull);
  out.volume = mass.volume;
  out.inertia = mass.inertia;
  out.radius = form.radius;
  return out;
}

ReferenceBody::ReferenceBody(const Reference& truth, ConvexForm form, const Material& body,
                             const Material& floor, double rate)
    : truth_(truth),
      form_(std::move(form)),
      mass_(body.density * form_.volume),
      friction_(std::sqrt(body.friction * floor.friction)),
      restitution_(body.restitution * floor.restitution),
      dt_(1 / rate),
      inertia_(body.density * form_.inertia),
      inverse_inertia_(inertia_.inverse()) {}

void ReferenceBody::put(const BodyState& state) {
  state_ = state;
  const Mat3 turn = state_.pose.orientation.toRotationMatrix();
  world_inverse_ = turn * inverse_inertia_ * turn.transpose();
}

void ReferenceBody::add_corners(const Pose& pose, double margin, std::vector<Contact>& out) const {
  for (const Vec3& corner : form_.corners) {
    const Vec3 arm = pose.orientation * corner;
    const PointGap near = point_gap(truth_, pose.position + arm);
    if (near.gap <= margin) out.push_back({.normal = near.normal, .arm = arm, .gap = near.gap});
  }
}

void ReferenceBody::add_edges(const Pose& pose, double margin, std::vector<Contact>& out) const {
  for (const auto& [a, b] : form_.edges) {
    const Vec3 from = pose.orientation * form_.corners[std::size_t(a)];
    const Vec3 to = pose.orientation * form_.corners[std::size_t(b)];
    const double step = std::min(edge_step, 4 * truth_.spacing().maxCoeff());
    const int count = std::max(2, int(std::ceil((to - from).norm() / step)));
    const Vec3 direction = (to - from).normalized();
    std::vector<PointGap> gaps;
    for (int k = 0; k <= count; ++k)
      gaps.push_back(point_gap(truth_, pose.position + from + double(k) / count * (to - from)));
    for (std::size_t k = 1; k + 1 < gaps.size(); ++k) {
      const double here = gaps[k].gap;
      if (here > margin || gaps[k - 1].gap < here + same_gap || gaps[k + 1].gap < here - same_gap) continue;
      // An edge can only be pushed across.
      const Vec3 across = gaps[k].normal - gaps[k].normal.dot(direction) * direction;
      if (across.norm() < 0.3) continue;
      out.push_back(
          {.normal = across.normalized(), .arm = from + double(k) / count * (to - from), .gap = here});
    }
  }
}

void ReferenceBody::add_peaks_under(const Pose& pose, const ConvexForm::Face& face, double margin,
                                    std::vector<Contact>& out) const {
  const Vec3 normal = pose.orientation * face.normal;
  if (normal.z() > -0.05) return;
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int k : face.corners) {
    const Vec2 p = (pose.position + pose.orientation * form_.corners[std::size_t(k)]).head<2>();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // Gap of the grid's point (i, j) along the face's normal: below 0 it is inside.
  const Vec2 spacing = truth_.spacing();
  const double offset = face.offset + normal.dot(pose.position);
  const auto gap_at = [&](int i, int j) {
    return normal.x() * (i + 0.5) * spacing.x() + normal.y() * (j + 0.5) * spacing.y() +
           normal.z() * truth_.at(i, j) - offset;
  };
  const auto first = [&](int axis) { return int(std::ceil(low[axis] / spacing[axis] - 0.5)); };
  const auto last = [&](int axis) { return int(std::floor(high[axis] / spacing[axis] - 0.5)); };
  const Quat back = pose.orientation.conjugate();
  for (int j = first(1); j <= last(1); ++j) {
    for (int i = first(0); i <= last(0); ++i) {
      const double here = gap_at(i, j);
      if (here > margin) continue;
      const Vec3 p((i + 0.5) * spacing.x(), (j + 0.5) * spacing.y(), truth_.at(i, j));
      // Beside the face, its edges and corners are what touches.
      if (signed_distance(form_, back * (p - pose.position), &face) > -spacing.maxCoeff()) continue;
      bool is_least = true;
      for (int b = -1; b <= 1 && is_least; ++b)
        for (int a = -1; a <= 1 && is_least; ++a) {
          if (a == 0 && b == 0) continue;
          const bool is_before = b < 0 || (b == 0 && a < 0);
          is_least = gap_at(i + a, j + b) >= here + (is_before ? same_gap : -same_gap);
        }
      if (is_least) out.push_back({.normal = -normal, .arm = p - pose.position, .gap = here});
    }
  }
}

void ReferenceBody::add_peaks(const Pose& pose, double margin, std::vector<Contact>& out) const {
  for (const ConvexForm::Face& face : form_.faces) add_peaks_under(pose, face, margin, out);
}

std::vector<ReferenceBody::Contact> ReferenceBody::find_contacts(const Pose& pose, double margin) const {
  std::vector<Contact> out;
  if (pose.position.z() - form_.radius > margin) return out;
  add_corners(pose, margin, out);
  add_edges(pose, margin, out);
  add_peaks(pose, margin, out);
  std::stable_sort(out.begin(), out.end(), [](const Contact& a, const Contact& b) { return a.gap < b.gap; });
  if (out.size() > most_contacts) out.resize(most_contacts);
  return out;
}

double ReferenceBody::mobility(const Vec3& arm, const Vec3& direction) const {
  const Vec3 turn = arm.cross(direction);
  return 1 / mass_ + turn.dot(world_inverse_ * turn);
}

void ReferenceBody::prepare(bool bounces) {
  const double weight_speed = 3 * 9.81 * dt_;
  for (Contact& c : contacts_) {
    const double closing = -c.normal.dot(state_.velocity + state_.angular_velocity.cross(c.arm));
    c.wanted = std::min(0.0, -c.gap / dt_);
    if (bounces && closing > weight_speed + std::max(c.gap, 0.0) / dt_)
      c.wanted = std::max(c.wanted, restitution_ * closing);
    // One value for both directions, or friction would not be opposite to slip; this bounds the larger one.
    const Vec3 along = c.normal.unitOrthogonal();
    c.yielding = mobility(c.arm, along) + mobility(c.arm, c.normal.cross(along)) - 1 / mass_;
    c.normal_impulse = 0;
    c.friction_impulse = Vec3::Zero();
  }
}

void ReferenceBody::iterate() {
  const auto speed_at = [&](const Contact& c) -> Vec3 {
    return state_.velocity + state_.angular_velocity.cross(c.arm);
  };
  const auto push = [&](const Contact& c, const Vec3& impulse) {
    state_.velocity += impulse / mass_;
    state_.angular_velocity += world_inverse_ * c.arm.cross(impulse);
  };
  for (int iteration = 0; iteration < 40; ++iteration) {
    for (Contact& c : contacts_) {
      const double wanted = (c.wanted - c.normal.dot(speed_at(c))) / mobility(c.arm, c.normal);
      const double sum = std::max(c.normal_impulse + wanted, 0.0);
      push(c, (sum - c.normal_impulse) * c.normal);
      c.normal_impulse = sum;
      const Vec3 slip = speed_at(c);
      Vec3 friction = c.friction_impulse - (slip - slip.dot(c.normal) * c.normal) / c.yielding;
      const double most = friction_ * c.normal_impulse;
      if (friction.norm() > most) friction *= most / friction.norm();
      push(c, friction - c.friction_impulse);
      c.friction_impulse = friction;
    }
  }
}

void ReferenceBody::solve() {
  const BodyState before = state_;
  const double energy_before = energy();
  prepare(true);
  iterate();
  // Newton's restitution with friction can add energy (Kane and Levinson, 1985); then nothing bounces.
  if (energy() > energy_before) {
    state_ = before;
    prepare(false);
    iterate();
  }
  touches_ =
      std::any_of(contacts_.begin(), contacts_.end(), [](const Contact& c) { return c.normal_impulse > 0; });
}

// An overlap is undone by moving the body, a tenth of it a step: to undo it by speed would add energy.
void ReferenceBody::lift() {
  Vec3 way = Vec3::Zero(), turn = Vec3::Zero();
  std::vector<double> sums(contacts_.size(), 0.0);
  for (int iteration = 0; iteration < 10; ++iteration) {
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      const Contact& c = contacts_[k];
      if (c.gap >= 0) continue;
      const double wanted = 0.1 * -c.gap - c.normal.dot(way + turn.cross(c.arm));
      const double sum = std::max(sums[k] + wanted / mobility(c.arm, c.normal), 0.0);
      const Vec3 impulse = (sum - sums[k]) * c.normal;
      sums[k] = sum;
      way += impulse / mass_;
      turn += world_inverse_ * c.arm.cross(impulse);
    }
  }
  state_.pose.position += way;
  if (turn.norm() > 0) state_.pose.orientation = (rotation(turn) * state_.pose.orientation).normalized();
}

// The angular momentum is kept; the velocity half a step ahead turns the body.
void ReferenceBody::move() {
  state_.pose.position += dt_ * state_.velocity;
  const auto velocity_at = [&](const Quat& orientation, const Vec3& momentum) {
    return Vec3(orientation * (inverse_inertia_ * (orientation.conjugate() * momentum)));
  };
  const Quat before = state_.pose.orientation;
  const Vec3 momentum = before * (inertia_ * (before.conjugate() * state_.angular_velocity));
  const Quat half = rotation(0.5 * dt_ * state_.angular_velocity) * before;
  const Vec3 turn = dt_ * velocity_at(half, momentum);
  BodyState next = state_;
  next.pose.orientation = (rotation(turn) * before).normalized();
  next.angular_velocity = velocity_at(next.pose.orientation, momentum);
  put(next);
}

void ReferenceBody::step() {
  state_.velocity.z() -= 9.81 * dt_;
  // The distance that a corner may cover within a step.
  const double speed = state_.velocity.norm() + state_.angular_velocity.norm() * form_.radius;
  contacts_ = find_contacts(state_.pose, 1e-4 + speed * dt_);
  solve();
  lift();
  move();
}

std::vector<TouchPoint> ReferenceBody::touch_points() const {
  std::vector<TouchPoint> out;
  for (const Contact& c : contacts_)
    if (c.normal_impulse > 0)
      out.push_back(
          {state_.pose.position + c.arm, c.normal, c.normal_impulse * c.normal + c.friction_impulse});
  return out;
}

std::vector<Vec3> ReferenceBody::normals_at(const Pose& pose, double margin) const {
  std::vector<Vec3> out;
  for (const Contact& c : find_contacts(pose, margin)) out.push_back(c.normal);
  return out;
}

double ReferenceBody::gap_at(const Pose& pose, double reach) const {
  const std::vector<Contact> found = find_contacts(pose, reach);
  return found.empty() ? std::numeric_limits<double>::quiet_NaN() : found.front().gap;
}

double ReferenceBody::energy() const {
  const Vec3 spin = state_.pose.orientation.conjugate() * state_.angular_velocity;
  return 0.5 * mass_ * state_.velocity.squaredNorm() + 0.5 * spin.dot(inertia_ * spin) +
         mass_ * 9.81 * state_.pose.position.z();
}

}  // namespace intaglio::evaluate
