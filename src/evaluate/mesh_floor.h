// A relief as a triangle mesh, for comparison: a regular grid of vertices on the true relief.
//
// Touched by our own proxy through MeshSolid, rolled on in plain Bullet through MeshWorld. Any thread once
// made; a MeshWorld is used by one thread at a time.
#pragma once

#include <memory>
#include <vector>

#include "contact/shape.h"
#include "evaluate/reference.h"
#include "haptics/proxy.h"
#include "intaglio/event.h"
#include "intaglio/material.h"
#include "surface/surface.h"

namespace intaglio::evaluate {

class MeshFloor {
 public:
  // cells + 1 vertices a side, on the relief of `truth`, over the rectangle of `placement`.
  MeshFloor(const Reference& truth, const surface::Placement& placement, int cells);
  ~MeshFloor();

  int cells() const { return cells_; }
  std::size_t vertices() const { return z_.size(); }
  std::size_t bytes() const;                               // vertices, triangles and Bullet's tree
  double build_seconds() const { return build_seconds_; }  // thread-CPU
  const surface::Placement& placement() const { return placement_; }
  // Height of the triangle under local (x, y), and its slope. Clamped to the rectangle.
  struct Height {
    double z;
    Vec2 slope;
  };
  Height at(double x, double y) const;

  struct Bullet;  // its mesh shape
  const Bullet& bullet() const { return *bullet_; }

 private:
  double vertex(int i, int j) const { return z_[std::size_t(j) * std::size_t(cells_ + 1) + std::size_t(i)]; }

  int cells_;
  surface::Placement placement_;
  std::vector<double> z_;  // m, local
  std::unique_ptr<Bullet> bullet_;
  double build_seconds_ = 0;
};

// The mesh as the proxy feels it: its triangles, without a footprint.
class MeshSolid : public haptics::Solid {
 public:
  MeshSolid(std::shared_ptr<const MeshFloor> floor, double thickness)
      : floor_(std::move(floor)), thickness_(thickness) {}
  haptics::Penetration at(const Vec3& p) const override;

 private:
  std::shared_ptr<const MeshFloor> floor_;
  double thickness_;  // m
};

// A body as a physics engine moves it.
struct BodyState {
  Pose pose;
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
};

// Where two bodies touched during a step.
struct TouchPoint {
  Vec3 point, normal;  // m; unit, towards the moving body
  Vec3 impulse;        // N s, on it
};

// One body on a mesh in a Bullet world of its own, at that many steps a second: a ball, a box, or a hull
// whose frame is that of its principal axes. World frame.
class MeshWorld {
 public:
  MeshWorld(std::shared_ptr<const MeshFloor> floor, const Material& floor_material,
            const contact::Shape& shape, const Material& body, double rate);
  ~MeshWorld();

  void put(const BodyState& state);
  void step();
  BodyState state() const;
  // Those of the last step.
  std::vector<TouchPoint> touches() const;
  // Normals of the contacts at the body's pose, deepest first, without a step.
  std::vector<Vec3> normals();

 private:
  struct State;

  std::unique_ptr<State> state_;
};

}  // namespace intaglio::evaluate
