// How a box or a convex hull moves on the reference: a rigid body on a brute-force relief at 3,840 Hz.
//
// Contacts are the body's corners and points every 4 mm or less along its edges against the relief under
// them, and every point of the reference's grid under a face that looks down against that face; of each, the
// local minima of the gap. Newton's restitution, Coulomb friction, Euler's equations with the whole inertia;
// nothing of contact/, dynamics/ or Bullet. Boxes and hulls have no rolling resistance, as in the product.
// SI units, local coordinates of the surface (z up, out of it); the surface is horizontal. Deterministic;
// about 60 us a step of a body of 80 mm on a grid of 1 mm, less in flight.
#pragma once

#include <vector>

#include "contact/shape.h"
#include "evaluate/mesh_floor.h"
#include "evaluate/reference.h"
#include "evaluate/reference_motion.h"
#include "intaglio/material.h"

namespace intaglio::evaluate {

// Corners, edges and faces of a convex body in its own frame, about its centre of mass; m.
struct ConvexForm {
  struct Face {
    Vec3 normal;    // unit, outwards
    double offset;  // normal . x on the face
    std::vector<int> corners;
  };
  std::vector<Vec3> corners;
  std::vector<std::pair<int, int>> edges;
  std::vector<Face> faces;
  double volume = 0;            // m^3
  Mat3 inertia = Mat3::Zero();  // for density 1
  double radius = 0;            // m, of the farthest corner
};
ConvexForm box_form(const Vec3& half);
// A hull must have its centre of mass at its origin.
ConvexForm hull_form(const contact::ConvexHull& hull);

class ReferenceBody {
 public:
  ReferenceBody(const Reference& truth, ConvexForm form, const Material& body, const Material& floor,
                double rate = reference_rate);

  void put(const BodyState& state);
  const BodyState& state() const { return state_; }
  void step();
  bool touches() const { return touches_; }
  std::vector<TouchPoint> touch_points() const;  // of the last step
  // Normals of the contacts of a body there that are within `margin` metres, nearest first.
  std::vector<Vec3> normals_at(const Pose& pose, double margin) const;
  // The smallest gap of a body there, along the normals of its contacts; below 0 it overlaps. Not a number
  // when
  // it is farther than `reach` from the relief.
  double gap_at(const Pose& pose, double reach) const;
  // Kinetic and potential energy, J.
  double energy() const;
  double mass() const { return mass_; }

 private:
  struct Contact {
    Vec3 normal, arm;   // unit, towards the body; from the centre to the point
    double gap;         // m
    double wanted = 0;  // least normal velocity, m/s
    double normal_impulse = 0;
    double yielding = 0;  // speed that friction changes by, m/s per N s
    Vec3 friction_impulse = Vec3::Zero();
  };
  std::vector<Contact> find_contacts(const Pose& pose, double margin) const;
  void add_corners(const Pose& pose, double margin, std::vector<Contact>& out) const;
  void add_edges(const Pose& pose, double margin, std::vector<Contact>& out) const;
  void add_peaks(const Pose& pose, double margin, std::vector<Contact>& out) const;
  void add_peaks_under(const Pose& pose, const ConvexForm::Face& face, double margin,
                       std::vector<Contact>& out) const;
  double mobility(const Vec3& arm, const Vec3& direction) const;
  void prepare(bool bounces);
  void iterate();
  void solve();
  void lift();
  void move();

  const Reference& truth_;
  ConvexForm form_;
  double mass_, friction_, restitution_, dt_;
  Mat3 inertia_, inverse_inertia_;         // body frame
  Mat3 world_inverse_ = Mat3::Identity();  // at the state's orientation
  BodyState state_;
  std::vector<Contact> contacts_;
  bool touches_ = false;
};

}  // namespace intaglio::evaluate
