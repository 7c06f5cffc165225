#include "intaglio/haptics/servo.h"

#include <cmath>
#include <numbers>

#include "intaglio/haptics/plane.h"

namespace intaglio::haptics {

DepthTest depth_test(const surface::Surface& surface, Representation representation, const Vec3& tip_local) {
  const surface::Placement& place = surface.placement();
  if (!tip_local.allFinite() || !place.covers(tip_local)) return {};
  const double z = representation == Representation::relief ? -surface.depth(place.uv(tip_local)) : 0.0;
  return {tip_local.z() < z, Vec3(tip_local.x(), tip_local.y(), z)};
}

PenServo::PenServo(std::shared_ptr<const surface::Surface> surface, const ServoOptions& options)
    : surface_(std::move(surface)), options_(options), guard_(options.limits) {}

ServoSample PenServo::refuse(Device& device, const Vec3& position, double dt) {
  // The guard sees the bad number, so that it latches; the filter does not, so that rearm() brings back a
  // sound state.
  started_ = false;
  velocity_.setZero();
  ServoSample sample;
  sample.wanted = position;
  const GuardedForce guarded = guard_.pass(position, dt);
  device.write(guarded);
  sample.force = guarded.newtons();
  sample.guard_status = guard_.status();
  return sample;
}

ServoSample PenServo::tick(Device& device) {
  const double dt = 1.0 / options_.rate;
  const Vec3 position = device.read();
  if (!position.allFinite()) return refuse(device, position, dt);
  if (!started_) last_position_ = position;
  started_ = true;
  const double keep = std::exp(-2 * std::numbers::pi * options_.velocity_cutoff * dt);
  velocity_ = keep * velocity_ + (1 - keep) * (position - last_position_) / dt;
  last_position_ = position;

  const surface::Placement& place = surface_->placement();
  ServoSample sample;
  sample.tip = options_.workspace.to_world(position);
  sample.velocity = options_.workspace.scale * velocity_;
  const DepthTest test = depth_test(*surface_, options_.representation, place.to_local(sample.tip));
  sample.uv = place.uv(place.to_local(sample.tip));
  sample.surface_height = test.projected.z();
  sample.touching = test.collides;
  sample.proxy = test.collides ? place.to_world(test.projected) : sample.tip;
  if (test.collides) {
    sample.n_s =
        options_.representation == Representation::flat ? place.n() : surface_->world_normal(sample.uv);
    // The spring lives in the device's workspace, so that its stiffness is what the hand feels whatever the
    // scale.
    const Plane plane =
        tangent_plane(options_.workspace.to_device(place.to_world(test.projected)), sample.n_s);
    sample.wanted = plane_force(plane, options_.spring, position, velocity_);
  }
  const GuardedForce guarded = guard_.pass(sample.wanted, dt);
  device.write(guarded);
  sample.force = guarded.newtons();
  sample.guard_status = guard_.status();
  return sample;
}

}  // namespace intaglio::haptics
