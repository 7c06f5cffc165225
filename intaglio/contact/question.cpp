#include "intaglio/contact/question.h"

#include <algorithm>
#include <cmath>

namespace intaglio::contact {

namespace {

bool is_size(double size) {
  return size > 0 && std::isfinite(size);
}

struct HasSize {
  bool operator()(const Sphere& s) const { return is_size(s.radius); }
  bool operator()(const Capsule& s) const { return is_size(s.radius) && is_size(s.half_height); }
  bool operator()(const Box& s) const { return is_size(s.half.minCoeff()) && s.half.allFinite(); }
  bool operator()(const Cylinder& s) const { return is_size(s.radius) && is_size(s.half_height); }
  bool operator()(const ConvexHull& s) const { return s.form != nullptr; }
  bool operator()(const Mesh& s) const { return s.form != nullptr; }
  bool operator()(const Compound& s) const { return s.children != nullptr && !s.children->empty(); }
};

}  // namespace

bool is_rigid(const Pose& pose) {
  const double norm2 = pose.orientation.squaredNorm();
  return pose.position.allFinite() && norm2 > 1e-12 && norm2 < 1e12;
}

bool has_size(const Shape& shape) {
  return std::visit(HasSize{}, shape);
}

Question::Question(const surface::Surface& asked, const Shape& shape, const Pose& pose, double wanted_margin)
    : surface(asked), frame{}, reach(0), margin(0), wrong(status::ok), hopeless(true) {
  const surface::Placement& place = surface.placement();
  if (!is_rigid(pose)) {
    wrong = status::bad_pose;
    return;
  }
  if (!has_size(shape)) {
    wrong = status::no_size;
    return;
  }
  reach = bounding_radius(shape);
  if (!std::isfinite(reach)) {
    wrong = status::no_size;
    return;
  }
  const double side = std::min(place.size_u(), place.size_v());
  margin = wanted_margin > 0 ? std::min(wanted_margin, side) : 0;
  if (!(wanted_margin <= side)) wrong |= status::wide_margin;
  frame.origin = place.to_local(pose.position);
  if (frame.origin.norm() > 1e5 * std::max(place.size_u(), place.size_v())) {
    wrong |= status::far;
    return;
  }
  const Mat3 turn = pose.orientation.normalized().toRotationMatrix();
  for (int k = 0; k < 3; ++k) frame.axes.col(k) = place.direction_to_local(turn.col(k));
  const double wide = reach + margin;
  const Vec3& at = frame.origin;
  if (at.x() < -wide || at.y() < -wide || at.x() > place.size_u() + wide || at.y() > place.size_v() + wide) {
    wrong |= status::off_edge;
    return;
  }
  hopeless = at.z() > wide;
}

}  // namespace intaglio::contact
