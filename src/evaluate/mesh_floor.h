// A relief as a triangle mesh, for comparison: a regular grid of vertices on the true relief.
//
// Touched by our own proxy through MeshSolid, rolled on in plain Bullet through MeshWorld. Any thread once
// made; a MeshWorld is used by one thread at a time.
#pragma once

#include <memory>
#include <span>
#include <vector>

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
  std::size_t bytes() const;  // vertices, triangles and Bullet's tree
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

// One ball on a mesh in a Bullet world of its own, at that many steps a second.
class MeshWorld {
 public:
  MeshWorld(std::shared_ptr<const MeshFloor> floor, const Material& floor_material, double radius,
            const Material& ball, double rate);
  ~MeshWorld();

  void put(const BodyState& state);
  void step();
  BodyState state() const;
  // Contacts of the last step, as intaglio::World gives them.
  std::span<const ContactEvent> events() const { return events_; }
  // Normals of the contacts at the body's pose, deepest first, without a step.
  std::vector<Vec3> normals();

 private:
  struct State;
  void collect_events();

  std::unique_ptr<State> state_;
  std::vector<ContactEvent> events_;
  bool touched_ = false;
};

}  // namespace intaglio::evaluate
