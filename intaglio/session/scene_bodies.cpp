// Balls and bodies of a scene file.
#include <fmt/format.h>

#include <array>
#include <numbers>

#include "intaglio/core/material_reader.h"
#include "intaglio/core/rotation.h"
#include "intaglio/session/letter.h"
#include "intaglio/session/scene_reader.h"

namespace intaglio::session {

namespace {

constexpr Range length{0.001, 10, false, "a length must be between 0.001 m and 10 m"};

// Positions are those of the world, or of the floor: x to the right, y out of it, z towards its lower edge,
// from its middle.
Pose read_frame(TomlReader& r, const SurfaceScene& floor) {
  int frame = 0;
  r.choice("frame", {"world", "floor"}, frame);
  return frame == 0 ? Pose{} : Pose{floor.position, rotation_of(floor.rotation)};
}

void read_mass(TomlReader& r, double mass_now, Material& material) {
  if (!r.has("mass")) return r.optional_key("mass");
  double mass = 0;
  r.number("mass", mass, positive("a mass must be greater than 0 kg"));
  if (!(mass_now > 0)) return;
  const double density = material.density * mass / mass_now;
  if (!(density >= 1 && density <= 1e5))
    return r.fail_at("mass", fmt::format("a mass of {:g} kg would make it of {:.3g} kg/m3", mass, density),
                     fmt::format("between 1 and 100000 kg/m3, a mass of {:.2g} to {:.2g} kg",
                                 mass_now / material.density, 1e5 * mass_now / material.density));
  material.density = density;
}

contact::Shape read_shape(TomlReader& r, std::string& name) {
  const std::vector<std::string> names = {"box", "sphere", "capsule", "cylinder", "letter"};
  int shape = 0;
  r.choice("shape", names, shape);
  name = names[static_cast<std::size_t>(shape)];
  Vec3 size = Vec3::Constant(0.1);
  double radius = 0.05, height = 0.1;
  std::string letter = "A";
  r.vector("size", size);
  r.number("radius", radius, length);
  r.number("height", height, length);
  r.text("letter", letter);
  if ((shape == 0 || shape == 4) && (size.minCoeff() < 0.001 || size.maxCoeff() > 10))
    r.fail_at("size", "a side of the body is out of range", "sides must be between 0.001 m and 10 m");
  static const std::array<std::vector<const char*>, 5> uses = {
      {{"size"}, {"radius"}, {"radius", "height"}, {"radius", "height"}, {"letter", "size"}}};
  r.only_keys("a " + name, uses[static_cast<std::size_t>(shape)], {"size", "radius", "height", "letter"});
  switch (shape) {
    case 1:
      return contact::Sphere{radius};
    case 2:
      return contact::Capsule{radius, 0.5 * height};
    case 3:
      return contact::Cylinder{radius, 0.5 * height};
    case 4: {
      name += " " + letter;
      auto form = letter_shape(letter, size);
      if (form) return *form;
      r.fail_at("letter", "there is no letter " + letter, "one of A to Z or 0 to 9");
      return contact::Box{0.5 * size};
    }
    default:
      return contact::Box{0.5 * size};
  }
}

void read_flipper(TomlReader& r, BodyScene& body) {
  Flipper flipper;
  const bool is_flipper = r.has("key");
  r.choice("key", {"left", "right"}, flipper.key);
  r.vector("pivot", flipper.pivot);
  read_direction(r, "axis", flipper.axis);
  r.number("sweep", flipper.sweep, {-180, 180, false, "a sweep must be between -180 and 180 degrees"});
  if (!is_flipper)
    return r.only_keys("a body that is no flipper (key = \"left\" or \"right\")", {},
                       {"pivot", "axis", "sweep"});
  r.only_keys("a flipper, which its key moves", {"pivot", "axis", "sweep"}, {"motion", "velocity", "spin"});
  flipper.axis.normalize();
  body.flipper = flipper;
  body.body.motion = dynamics::Motion::driven;
}

void read_colour(TomlReader& r, Vec3& colour) {
  r.vector("colour", colour);
  if (colour.minCoeff() < 0 || colour.maxCoeff() > 1)
    r.fail_at("colour", "colour is out of range", "give linear red, green, blue from 0 to 1");
}

}  // namespace

Quat rotation_of(const Vec3& degrees) {
  const Vec3 r = degrees * std::numbers::pi / 180;
  return rotation(r.z(), Vec3::UnitZ()) * rotation(r.y(), Vec3::UnitY()) * rotation(r.x(), Vec3::UnitX());
}

void read_direction(TomlReader& r, const char* key, Vec3& direction) {
  r.vector(key, direction);
  if (direction.norm() < 1e-9 || direction.norm() > 1e9)
    r.fail_at(key, std::string(key) + " has no direction", "give a vector that is not zero");
}

void read_ball(TomlReader& r, const SurfaceScene& floor, std::vector<BallScene>& balls) {
  BallScene ball;
  ball.material = *find_material("plastic");
  r.number("radius", ball.radius, {0.001, 10, false, "a radius must be between 0.001 m and 10 m"});
  read_material(r, "material", ball.material);
  read_mass(r, ball.mass(), ball.material);
  const Pose frame = read_frame(r, floor);
  r.vector("position", ball.position);
  r.vector("velocity", ball.velocity);
  r.vector("spin", ball.angular_velocity);
  if (r.has("colour")) {
    read_colour(r, ball.colour.emplace(Vec3::Zero()));
  } else {
    r.optional_key("colour");
  }
  ball.position = frame.to_world(ball.position);
  ball.velocity = frame.orientation * ball.velocity;
  ball.angular_velocity = frame.orientation * ball.angular_velocity;
  balls.push_back(ball);
}

void read_body(TomlReader& r, const SurfaceScene& floor, std::vector<BodyScene>& bodies) {
  BodyScene body;
  dynamics::ShapeBody& is = body.body;
  is.shape = read_shape(r, body.name);
  is.material = *find_material("wood");
  read_material(r, "material", is.material);
  read_mass(r, is.mass(), is.material);
  int motion = 0;
  r.choice("motion", {"free", "fixed"}, motion);
  is.motion = static_cast<dynamics::Motion>(motion);
  const Pose frame = read_frame(r, floor);
  Vec3 position = Vec3::Zero(), degrees = Vec3::Zero(), velocity = Vec3::Zero(), spin = Vec3::Zero();
  r.vector("position", position);
  r.vector("rotation", degrees);
  r.vector("velocity", velocity);
  r.vector("spin", spin);
  read_colour(r, body.colour);
  r.number("kick", body.kick, at_least_zero("a kick must be between 0 and 20 m/s", 20));
  read_flipper(r, body);
  if (is.motion == dynamics::Motion::fixed) r.only_keys("a fixed body", {}, {"velocity", "spin"});
  read_reliefs(r, is.shape, body.reliefs);
  is.pose = {frame.to_world(position), frame.orientation * rotation_of(degrees)};
  is.velocity = frame.orientation * velocity;
  is.angular_velocity = frame.orientation * spin;
  bodies.push_back(std::move(body));
}

}  // namespace intaglio::session
