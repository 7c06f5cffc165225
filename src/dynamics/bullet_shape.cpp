#include "dynamics/bullet_shape.h"

#include <LinearMath/btConvexHullComputer.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>
#include <numbers>

#include "contact/polyhedron.h"
#include "core/portable_math.h"
#include "dynamics/textured_shape.h"

namespace intaglio::dynamics {

namespace {

// Limit of the scale of a reduced hull, which is 1.007 for a ball.
constexpr double max_scale = 1.03;

// A shape round the Y axis, turned to another axis.
contact::Shape along(const contact::Shape& shape, int axis) {
  if (axis == 1) return shape;
  const Vec3 to = axis == 0 ? Vec3::UnitX() : Vec3::UnitZ();
  return contact::make_compound({{shape, {Vec3::Zero(), rotation_onto(Vec3::UnitY(), to)}}});
}

Result<contact::Shape> from_compound(const btCompoundShape& shape) {
  std::vector<contact::CompoundChild> children;
  for (int k = 0; k < shape.getNumChildShapes(); ++k) {
    const auto child = from_bullet(*shape.getChildShape(k));
    if (!child) return child;
    children.push_back({*child, from_bullet(shape.getChildTransform(k))});
  }
  return contact::make_compound(std::move(children));
}

contact::MassProperties mass_properties(const btConvexHullComputer& hull) {
  contact::EnclosedMass sum;
  const auto corner = [&](const btConvexHullComputer::Edge* e) {
    return from_bullet(hull.vertices[e->getSourceVertex()]);
  };
  for (int f = 0; f < hull.faces.size(); ++f) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
    for (const auto* e = first->getNextEdgeOfFace(); e->getNextEdgeOfFace() != first;
         e = e->getNextEdgeOfFace())
      sum.add(corner(first), corner(e), corner(e->getNextEdgeOfFace()));
  }
  return sum.properties();
}

// `count` directions spread evenly over a sphere, along a spiral.
Vec3 spiral_direction(int k, int count) {
  const double z = 1 - (2 * k + 1.0) / count, angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
  const double across = std::sqrt(1 - z * z);
  return {across * elementary::cos(angle), across * elementary::sin(angle), z};
}

using Hull = Result<std::shared_ptr<const contact::Polyhedron>>;

// A hull of at most max_hull_points corners: the farthest points along that many directions. They cut off up
// to 2 % of a ball; scaling about the centre restores the volume of the whole hull.
Hull reduced_hull(const std::vector<Vec3>& points) {
  btConvexHullComputer computer;
  computer.compute(points.front().data(), int(sizeof(Vec3)), int(points.size()), 0, 0);
  const contact::MassProperties whole = mass_properties(computer);
  std::vector<Vec3> kept;
  for (int k = 0; k < int(max_hull_points); ++k) {
    const Vec3 direction = spiral_direction(k, int(max_hull_points));
    kept.push_back(*std::max_element(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) {
      return a.dot(direction) < b.dot(direction);
    }));
  }
  const Hull first = contact::convex_hull(kept);
  if (!first) return first;
  const double volume = contact::mass_properties(contact::ConvexHull{*first}).volume;
  const double scale = std::cbrt(std::abs(whole.volume) / volume);
  if (!(scale < max_scale))
    return fail("convex hull", "its volume needs too many corners",
                fmt::format("{} corners at most", max_hull_points));
  for (Vec3& p : kept) p = whole.centre + scale * (p - whole.centre);
  return contact::convex_hull(kept);
}

Hull make_hull(const std::vector<Vec3>& points) {
  Hull hull = contact::convex_hull(points);
  const bool are_finite =
      std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
  return hull || points.size() <= max_hull_points || !are_finite ? hull : reduced_hull(points);
}

// Returns the hull from a cache of the latest ones. Bullet makes a new collision algorithm, which needs the
// hull, whenever a pair comes near. Keyed by the points themselves: a shape's address may be reused, and its
// points may change.
Hull hull_of(std::vector<Vec3> points) {
  struct Entry {
    std::vector<Vec3> points;
    Hull hull;
  };
  constexpr std::size_t capacity = 64;
  static std::mutex mutex;
  static std::deque<Entry> entries;
  const std::lock_guard lock(mutex);
  const auto known =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.points == points; });
  if (known != entries.end()) return known->hull;
  if (entries.size() == capacity) entries.pop_front();
  Hull hull = make_hull(points);
  entries.push_back({std::move(points), hull});
  return hull;
}

Result<contact::Shape> named(const char* name, const Hull& hull) {
  if (!hull) return fail(name, hull.error().what, hull.error().fix);
  return contact::ConvexHull{*hull};
}

// A hull or mesh of ours: Bullet's algorithms use the hull of its corners, ours the form itself.
class FormShape : public btConvexHullShape {
 public:
  FormShape(contact::Shape shape, const contact::Polyhedron& form) : shape_(std::move(shape)) {
    for (const Vec3& v : form.vertices) addPoint(to_bullet(v), false);
    recalcLocalAabb();
    // By default Bullet rounds hulls by a margin of 4 cm.
    setMargin(btScalar(1e-3 * form.radius));
  }
  const contact::Shape& shape() const { return shape_; }

 private:
  contact::Shape shape_;
};

Result<contact::Shape> from_hull(const btConvexHullShape& hull) {
  if (const auto* ours = dynamic_cast<const FormShape*>(&hull)) return ours->shape();
  std::vector<Vec3> points;
  for (int k = 0; k < hull.getNumPoints(); ++k) points.push_back(from_bullet(hull.getScaledPoint(k)));
  return named("btConvexHullShape", hull_of(std::move(points)));
}

Result<contact::Shape> from_convex(const btConvexShape& shape) {
  constexpr int directions = 42;
  std::vector<Vec3> points;
  for (int k = 0; k < directions; ++k)
    points.push_back(from_bullet(shape.localGetSupportingVertex(to_bullet(spiral_direction(k, directions)))));
  return named(shape.getName(), hull_of(std::move(points)));
}

}  // namespace

Result<contact::Shape> from_bullet(const btCollisionShape& shape) {
  switch (shape.getShapeType()) {
    case SPHERE_SHAPE_PROXYTYPE:
      return contact::Sphere{static_cast<const btSphereShape&>(shape).getRadius()};
    case BOX_SHAPE_PROXYTYPE:
      return contact::Box{from_bullet(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin())};
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      return along(contact::Capsule{capsule.getRadius(), capsule.getHalfHeight()}, capsule.getUpAxis());
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      const int axis = cylinder.getUpAxis();
      return along(contact::Cylinder{cylinder.getRadius(), cylinder.getHalfExtentsWithMargin()[axis]}, axis);
    }
    case COMPOUND_SHAPE_PROXYTYPE:
      return from_compound(static_cast<const btCompoundShape&>(shape));
    case CONVEX_HULL_SHAPE_PROXYTYPE:
      return from_hull(static_cast<const btConvexHullShape&>(shape));
    case EMPTY_SHAPE_PROXYTYPE:
      return contact::Sphere{0};  // touches nothing
    default:
      if (shape.isConvex()) return from_convex(static_cast<const btConvexShape&>(shape));
      return fail(shape.getName(), "is neither convex nor a compound of convex shapes",
                  "use a TexturedShape or a CurvedShape");
  }
}

Result<void> check_shape(const btCollisionShape& shape) {
  if (shape.getShapeType() == CUSTOM_CONCAVE_SHAPE_TYPE) return {};
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int k = 0; k < compound.getNumChildShapes(); ++k)
      if (const auto child = check_shape(*compound.getChildShape(k)); !child) return child;
    return {};
  }
  if (const auto made = from_bullet(shape); !made) return tl::unexpected(made.error());
  return {};
}

namespace {

using Part = std::unique_ptr<btCollisionShape>;

struct MakePart {
  btScalar f(double x) const { return btScalar(x); }
  Part operator()(const contact::Sphere& s) const { return std::make_unique<btSphereShape>(f(s.radius)); }
  Part operator()(const contact::Capsule& s) const {
    return std::make_unique<btCapsuleShape>(f(s.radius), f(2 * s.half_height));
  }
  Part operator()(const contact::Box& s) const { return std::make_unique<btBoxShape>(to_bullet(s.half)); }
  Part operator()(const contact::Cylinder& s) const {
    return std::make_unique<btCylinderShape>(to_bullet(Vec3(s.radius, s.half_height, s.radius)));
  }
  Part operator()(const contact::ConvexHull& s) const { return std::make_unique<FormShape>(s, *s.form); }
  Part operator()(const contact::Mesh& s) const { return std::make_unique<FormShape>(s, *s.form); }
  Part operator()(const contact::Compound&) const { return nullptr; }
};

// Adds the parts of a shape at `pose` to a compound.
void add_parts(const contact::Shape& shape, const Pose& pose, btCompoundShape& compound,
               std::vector<Part>& parts) {
  if (const auto* inner = std::get_if<contact::Compound>(&shape)) {
    for (const contact::CompoundChild& child : *inner->children)
      add_parts(child.shape, {pose.to_world(child.pose.position), pose.orientation * child.pose.orientation},
                compound, parts);
    return;
  }
  parts.push_back(std::visit(MakePart{}, shape));
  compound.addChildShape(to_bullet(pose), parts.back().get());
}

}  // namespace

BulletShape to_bullet(const contact::Shape& shape, const Pose& pose) {
  BulletShape out;
  const bool in_place = pose.position.isZero() && pose.orientation.vec().isZero();
  if (in_place && !std::holds_alternative<contact::Compound>(shape)) {
    out.parts.push_back(std::visit(MakePart{}, shape));
    return out;
  }
  auto compound = std::make_unique<btCompoundShape>();
  add_parts(shape, pose, *compound, out.parts);
  out.parts.push_back(std::move(compound));
  return out;
}

// Textured bodies.

namespace {

// A box between two corners.
struct BoxSides {
  Vec3 low, high;

  explicit BoxSides(const Vec3& half) : low(-half), high(half) {}
  // Moves the side that the normal leaves by.
  void inset(const Vec3& normal, double by) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    if (normal[axis] > 0) {
      high[axis] = std::max(high[axis] - by, low[axis] + 1e-6);
    } else {
      low[axis] = std::min(low[axis] + by, high[axis] - 1e-6);
    }
  }
  Vec3 middle() const { return 0.5 * (low + high); }
  contact::Box box() const { return {0.5 * (high - low)}; }
  double extent(const Vec3& normal) const { return normal.cwiseAbs().dot(high - low); }
};

double mean_depth(const surface::Surface& s) {
  double sum = 0;
  for (int j = 0; j < s.height(); ++j)
    for (int i = 0; i < s.width(); ++i) sum -= s.texel_z(i, j);
  return s.has_depth() ? sum / (double(s.width()) * s.height()) : 0;
}

const contact::Box* box_of(const ShapeBody& body) {
  return body.faces.empty() ? nullptr : std::get_if<contact::Box>(&body.shape);
}

}  // namespace

contact::MassProperties mass_properties(const ShapeBody& body) {
  if (body.skin) return CurvedShape(*body.skin).mass_properties();
  const contact::Box* box = box_of(body);
  if (box == nullptr) return contact::mass_properties(body.shape);
  BoxSides sides(box->half);
  for (const auto& face : body.faces) sides.inset(face->placement().n(), mean_depth(*face));
  contact::MassProperties out = contact::mass_properties(sides.box());
  out.centre = sides.middle();
  return out;
}

double reach(const ShapeBody& body) {
  const double plain = contact::bounding_radius(body.shape);
  if (!body.skin) return plain;
  const surface::Bounds bounds = body.skin->bounds();
  return std::max(plain, bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs()).norm());
}

double texel(const ShapeBody& body) {
  if (body.skin) return body.skin->texel_size();
  double least = 0;
  for (const auto& face : body.faces) {
    const double own = std::min(face->texel_u(), face->texel_v());
    least = least > 0 ? std::min(least, own) : own;
  }
  return least;
}

BulletShape to_bullet(const ShapeBody& body, const Pose& shape_pose) {
  BulletShape out;
  auto root = std::make_unique<btCompoundShape>();
  const auto add = [&](std::unique_ptr<btCollisionShape> part, const Pose& pose) {
    out.parts.push_back(std::move(part));
    root->addChildShape(to_bullet(pose), out.parts.back().get());
  };
  const contact::Box* box = box_of(body);
  if (body.skin) {
    add(std::make_unique<CurvedShape>(*body.skin), shape_pose);
  } else if (box != nullptr) {
    BoxSides core(box->half);
    for (const auto& face : body.faces) {
      const Vec3 n = face->placement().n();
      const double texel = std::max(face->texel_u(), face->texel_v());
      const double thickness = std::min(face->max_depth() + texel, 0.5 * BoxSides(box->half).extent(n));
      add(std::make_unique<TexturedShape>(face, ContactOptions{}, thickness), shape_pose);
      core.inset(n, face->max_depth());
    }
    add(std::make_unique<btBoxShape>(to_bullet(core.box().half)),
        {shape_pose.to_world(core.middle()), shape_pose.orientation});
  } else {
    return to_bullet(body.shape, shape_pose);
  }
  out.parts.push_back(std::move(root));
  return out;
}

surface::ReliefMesh flattened(const surface::ReliefMesh& relief) {
  surface::Texels flat;
  flat.width = flat.height = 4;
  flat.depth.assign(16, 0.0f);
  flat.normal.assign(16, Vec3::UnitZ());
  const auto plane = std::make_shared<const surface::Surface>(std::move(flat), relief.surface().placement(),
                                                              0.0, surface::Edge::wrap);
  auto made = surface::ReliefMesh::make(plane, relief.base());
  return made ? *made : relief;  // a flat relief always succeeds
}

}  // namespace intaglio::dynamics
