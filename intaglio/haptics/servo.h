// One tick of the haptic loop, the paper's way: plane, depth test, damped spring, guard, device.
//
// Real-time: tick() does not allocate, lock, log or throw, and samples the surface once (about 0.2 us). One
// thread.
#pragma once

#include <memory>

#include "intaglio/core/representation.h"
#include "intaglio/haptics/devices/device.h"
#include "intaglio/haptics/force.h"
#include "intaglio/haptics/guard.h"
#include "intaglio/surface/surface.h"

namespace intaglio::haptics {

// How the device's workspace lies in the world: world = origin + scale * device. Forces are felt at the
// device's scale: a spring of K newtons a metre of *device* travel.
struct WorkspaceMap {
  Vec3 origin = Vec3::Zero();  // m, world
  double scale = 1;            // world metres a device metre

  Vec3 to_world(const Vec3& device) const { return origin + scale * device; }
  Vec3 to_device(const Vec3& world) const { return (world - origin) / scale; }
};

struct ServoOptions {
  Representation representation = Representation::relief;
  Spring spring;
  GuardLimits limits;
  WorkspaceMap workspace;
  double rate = 1000;           // Hz
  double velocity_cutoff = 60;  // Hz, of the filter on the differentiated encoders
};

// What one tick found and did. World frame, SI.
struct ServoSample {
  Vec3 tip = Vec3::Zero();       // m
  Vec3 velocity = Vec3::Zero();  // m/s, filtered
  Vec3 proxy = Vec3::Zero();     // m, where the tip is shown: on the surface while it touches
  Vec3 force = Vec3::Zero();     // N, as sent to the device
  Vec3 wanted = Vec3::Zero();    // N, before the guard
  Vec3 n_s = Vec3::UnitY();      // sampled normal
  Vec2 uv = Vec2::Zero();
  double surface_height = 0;  // m above the base plane, of the surface under the tip (<= 0)
  bool touching = false;
  std::uint32_t guard_status = 0;
};

struct DepthTest {
  bool collides = false;
  Vec3 projected = Vec3::Zero();  // local; the point of the surface under the tip
};

// Whether the tip (local frame) collides, and the point of the surface under it: in relief only below the
// depth map, otherwise below the base plane; never beside the rectangle.
// §1.3.2, Sterling & Lin 2016
DepthTest depth_test(const surface::Surface& surface, Representation representation, const Vec3& tip_local);

class PenServo {
 public:
  PenServo(std::shared_ptr<const surface::Surface> surface, const ServoOptions& options);

  // Reads the device, works out the force and writes it.
  ServoSample tick(Device& device);

  void rearm() { guard_.rearm(); }

 private:
  ServoSample refuse(Device& device, const Vec3& position, double dt);

  std::shared_ptr<const surface::Surface> surface_;
  ServoOptions options_;
  Guard guard_;
  Vec3 last_position_ = Vec3::Zero();  // device frame
  Vec3 velocity_ = Vec3::Zero();       // device frame
  bool started_ = false;
};

}  // namespace intaglio::haptics
