// What our algorithm in Bullet asks of a textured shape, flat or curved.
//
// Includes Bullet. One thread at a time.
#pragma once

#include <btBulletCollisionCommon.h>

#include <limits>

#include "intaglio/contact/contact_point.h"
#include "intaglio/contact/shape.h"

namespace intaglio::dynamics {

class TouchableShape : public btConcaveShape {
 public:
  // What is below the relief is solid, however deep.
  static constexpr double solid = std::numeric_limits<double>::infinity();

  // Bullet looks algorithms up by this number, and knows that such a shape is concave. What is under the
  // relief by more than `thickness` metres is behind the shape, not in it.
  explicit TouchableShape(double thickness = solid) : thickness_(thickness >= 0 ? thickness : solid) {
    m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE;
    m_collisionMargin = 0;
  }

  // Where a body that is at `pose` in this shape's frame touches it, or will within `margin` metres.
  virtual contact::ContactSet contacts(const contact::Shape& body, const Pose& pose, double margin) const = 0;
  // The scale of its detail, metres.
  virtual double texel() const = 0;
  // Whether contacts are those of a plane, whatever their normals.
  virtual bool is_plane() const { return false; }
  double thickness() const { return thickness_; }
  // Without what is deeper than the shape is thick.
  contact::ContactSet within_thickness(contact::ContactSet set) const;
  // How far ahead contacts may be asked for, metres: bodies farther off are not looked at.
  double look_ahead() const { return look_ahead_; }
  bool is_near(const btVector3& low, const btVector3& high) const {
    return TestAabbAgainstAabb2(low, high, low_, high_);
  }

  void getAabb(const btTransform& t, btVector3& low, btVector3& high) const override {
    // Bullet pairs what overlaps now; contacts are wanted before that.
    btTransformAabb(low_, high_, static_cast<btScalar>(look_ahead_), t, low, high);
  }
  void setLocalScaling(const btVector3&) override {}  // a surface has metres; make another one
  const btVector3& getLocalScaling() const override { return scaling_; }

 protected:
  double look_ahead_ = 0;
  btVector3 low_{0, 0, 0}, high_{0, 0, 0};  // what bodies are looked for in, in this shape's frame

 private:
  double thickness_;
  btVector3 scaling_{1, 1, 1};
};

// Where a textured body at `pose` in the ground's frame touches it: two rectangles, two curved bodies, or a
// curved body and a rectangle in either role.
contact::ContactSet touch_of_reliefs(const TouchableShape& body, const Pose& pose,
                                     const TouchableShape& ground, double margin);

}  // namespace intaglio::dynamics
