// A hand that is led along a line and presses with a constant load: how people explore a texture (lateral
// motion, Lederman and Klatzky 1987), without a person's variation.
//
// Along the surface its place is given; across it a mass carries the load and what the device pushes. Device
// frame, up is +Y; SI units.
#pragma once

#include "intaglio/vec.h"

namespace intaglio::evaluate {

class LedHand {
 public:
  LedHand(const Vec3& at, double load) : load_(load), position_(at) {}

  // The place along the surface from now on; the height is its own.
  void lead_to(const Vec3& place) {
    position_.x() = place.x();
    position_.z() = place.z();
  }
  // Moves up or down for `dt` seconds under the force on the hand, N.
  void advance(const Vec3& force, double dt) {
    constexpr double mass = 0.12, damping = 12;  // kg, N s/m
    speed_ += dt / mass * (force.y() - load_ - damping * speed_);
    position_.y() += dt * speed_;
  }
  const Vec3& position() const { return position_; }

 private:
  double load_;
  Vec3 position_;
  double speed_ = 0;
};

}  // namespace intaglio::evaluate
