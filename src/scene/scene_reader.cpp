#include "scene/scene_reader.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <variant>

#include "core/toml.h"
#include "intaglio/vec.h"

namespace intaglio::scene {

namespace {

constexpr Range length_range{0.001, 10, false, "a length must be between 0.001 m and 10 m"};

// Positions are in the world or in the floor's frame: origin at its centre, x right, y along the normal, z
// towards its lower edge.
Pose read_frame(TomlReader& r, const SurfaceSettings& floor) {
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
    return r.fail_at("mass",
                     fmt::format("a mass of {:g} kg implies a density of {:.3g} kg/m3", mass, density),
                     fmt::format("the density must be 1 to 100000 kg/m3: a mass of {:.2g} to {:.2g} kg",
                                 mass_now / material.density, 1e5 * mass_now / material.density));
  material.density = density;
}

contact::Shape read_shape(TomlReader& r, std::string& name) {
  const std::vector<std::string> names = {"box", "sphere", "capsule", "cylinder", "letter"};
  int shape = 0;
  r.choice("shape", names, shape);
  name = names[std::size_t(shape)];
  Vec3 size = Vec3::Constant(0.1);
  double radius = 0.05, height = 0.1;
  std::string letter = "A";
  r.vec3("size", size);
  r.number("radius", radius, length_range);
  r.number("height", height, length_range);
  r.string("letter", letter);
  if ((shape == 0 || shape == 4) && (size.minCoeff() < 0.001 || size.maxCoeff() > 10))
    r.fail_at("size", "a side of the body is out of range", "sides must be between 0.001 m and 10 m");
  static const std::array<std::vector<const char*>, 5> keys_of = {
      {{"size"}, {"radius"}, {"radius", "height"}, {"radius", "height"}, {"letter", "size"}}};
  r.only_keys("a " + name, keys_of[std::size_t(shape)], {"size", "radius", "height", "letter"});
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

void read_flipper(TomlReader& r, BodySettings& body) {
  Flipper flipper;
  const bool is_flipper = r.has("key");
  r.choice("key", {"left", "right"}, flipper.key);
  r.vec3("pivot", flipper.pivot);
  read_direction(r, "axis", flipper.axis);
  r.number("sweep", flipper.sweep, {-180, 180, false, "a sweep must be between -180 and 180 degrees"});
  if (!is_flipper)
    return r.only_keys("a body without a key (key = \"left\" or \"right\" makes a flipper)", {},
                       {"pivot", "axis", "sweep"});
  r.only_keys("a flipper (its key drives it)", {"pivot", "axis", "sweep"}, {"motion", "velocity", "spin"});
  flipper.axis.normalize();
  body.flipper = flipper;
  body.body.motion = dynamics::Motion::driven;
}

void read_colour(TomlReader& r, Vec3& colour) {
  r.vec3("colour", colour);
  if (colour.minCoeff() < 0 || colour.maxCoeff() > 1)
    r.fail_at("colour", "colour is out of range", "give linear red, green, blue from 0 to 1");
}

}  // namespace

Quat rotation_of(const Vec3& degrees) {
  const Vec3 r = degrees * std::numbers::pi / 180;
  return rotation(r.z(), Vec3::UnitZ()) * rotation(r.y(), Vec3::UnitY()) * rotation(r.x(), Vec3::UnitX());
}

void read_direction(TomlReader& r, const char* key, Vec3& direction) {
  r.vec3(key, direction);
  if (direction.norm() < 1e-9 || direction.norm() > 1e9)
    r.fail_at(key, std::string(key) + " has no direction", "give a vector that is not zero");
}

void read_ball(TomlReader& r, const SurfaceSettings& floor, std::vector<BallSettings>& balls) {
  BallSettings ball;
  ball.material = *find_material("plastic");
  r.number("radius", ball.radius, {0.001, 10, false, "a radius must be between 0.001 m and 10 m"});
  read_material(r, "material", ball.material);
  read_mass(r, ball.mass(), ball.material);
  const Pose frame = read_frame(r, floor);
  r.vec3("position", ball.position);
  r.vec3("velocity", ball.velocity);
  r.vec3("spin", ball.angular_velocity);
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

void read_body(TomlReader& r, const SurfaceSettings& floor, std::vector<BodySettings>& bodies) {
  BodySettings body;
  dynamics::ShapeBody& shape = body.body;
  shape.shape = read_shape(r, body.name);
  shape.material = *find_material("wood");
  read_material(r, "material", shape.material);
  read_mass(r, shape.mass(), shape.material);
  r.choice("motion", {"free", "fixed"}, shape.motion);
  const Pose frame = read_frame(r, floor);
  Vec3 position = Vec3::Zero(), degrees = Vec3::Zero(), velocity = Vec3::Zero(), spin = Vec3::Zero();
  r.vec3("position", position);
  r.vec3("rotation", degrees);
  r.vec3("velocity", velocity);
  r.vec3("spin", spin);
  read_colour(r, body.colour);
  r.number("kick", body.kick, at_least_zero("a kick must be between 0 and 20 m/s", 20));
  read_flipper(r, body);
  if (shape.motion == dynamics::Motion::fixed) r.only_keys("a fixed body", {}, {"velocity", "spin"});
  read_reliefs(r, shape.shape, body.reliefs);
  shape.pose = {frame.to_world(position), frame.orientation * rotation_of(degrees)};
  shape.velocity = frame.orientation * velocity;
  shape.angular_velocity = frame.orientation * spin;
  bodies.push_back(std::move(body));
}

void read_texture(TomlReader& r, SurfaceSettings& surface) {
  r.string("texture", surface.texture);
  surface.line = r.line_of("texture");
  r.choice("green", {"+Y", "-Y"}, surface.green);
  r.choice("polarity", {"depth", "height"}, surface.polarity);
  r.choice("edge", {"wrap", "clamp"}, surface.edge);
  r.number("depth", surface.depth, at_least_zero("depth must be between 0 m and 10 m", 10));
  r.choice("maps", {"fused", "raw"}, surface.mode);
}

namespace {

void read_repeat(TomlReader& r, Vec2& repeat) {
  r.vec2("repeat", repeat, {1, 64, false, "a texture can be repeated 1 to 64 times"});
  if (repeat != Vec2(std::floor(repeat.x()), std::floor(repeat.y())))
    r.fail_at("repeat", "repeat must be integers", "for example [8, 4]");
}

void only_keys_of_base(TomlReader& r, BaseSettings::Shape shape) {
  const std::vector<const char*> all = {"radius", "height", "file", "repeat"};
  switch (shape) {
    case BaseSettings::Shape::bowl:
      return r.only_keys("a bowl", {"radius", "repeat"}, all);
    case BaseSettings::Shape::cylinder:
      return r.only_keys("a cylinder", {"radius", "height", "repeat"}, all);
    case BaseSettings::Shape::sphere:
      return r.only_keys("a sphere", {"radius", "repeat"}, all);
    case BaseSettings::Shape::mesh:
      return r.only_keys("a mesh", {"file", "repeat"}, all);
  }
}

// The texture rectangle on a box's top (+Y) or, flipped, on its bottom (-Y).
SurfaceSettings face_surface(const contact::Box& box, bool bottom) {
  SurfaceSettings face;
  face.size = {2 * box.half.x(), 2 * box.half.z()};
  face.position = {0, bottom ? -box.half.y() : box.half.y(), 0};
  face.rotation = {bottom ? 180.0 : 0.0, 0, 0};
  face.thickness = box.half.y();
  return face;
}

}  // namespace

void read_base(TomlReader& r, SurfaceSettings& surface) {
  r.table("base", [&](TomlReader& reader) {
    BaseSettings& base = surface.base.emplace();
    reader.choice("shape", {"bowl", "cylinder", "sphere", "mesh"}, base.shape);
    reader.number("radius", base.radius, {0.01, 100, false, "a radius must be between 0.01 m and 100 m"});
    reader.number("height", base.height, {0.01, 100, false, "a height must be between 0.01 m and 100 m"});
    reader.string("file", base.file);
    read_repeat(reader, base.repeat);
    base.line = reader.line_of("file");
    only_keys_of_base(reader, base.shape);
    if (base.shape == BaseSettings::Shape::mesh && base.file.empty())
      reader.fail_at("shape", "a mesh has no file", "give file = \"bowl.glb\", with texture coordinates");
  });
  if (surface.base) r.only_keys("a ground with a base", {"base"}, {"size"});
}

void read_reliefs(TomlReader& r, const contact::Shape& shape, std::vector<SurfaceSettings>& reliefs) {
  const auto* box = std::get_if<contact::Box>(&shape);
  const auto* ball = std::get_if<contact::Sphere>(&shape);
  const auto read_face = [&](TomlReader& t, bool bottom) {
    SurfaceSettings face = face_surface(box == nullptr ? contact::Box{Vec3::Ones()} : *box, bottom);
    read_texture(t, face);
    reliefs.push_back(std::move(face));
  };
  for (const char* side : {"top", "bottom"})
    if (box == nullptr && r.has(side))
      r.fail_at(side, std::string("this body has no ") + side, "only a box has; a sphere takes a skin");
  r.table("top", [&](TomlReader& t) { read_face(t, false); });
  r.table("bottom", [&](TomlReader& t) { read_face(t, true); });
  if (ball == nullptr && r.has("skin"))
    r.fail_at("skin", "this body has no skin", "only a sphere has; a box takes a top and a bottom");
  r.table("skin", [&](TomlReader& t) {
    SurfaceSettings skin;
    BaseSettings& base = skin.base.emplace();
    base.shape = BaseSettings::Shape::sphere;
    base.radius = ball == nullptr ? 1 : ball->radius;
    read_texture(t, skin);
    read_repeat(t, base.repeat);
    base.line = t.line_of("texture");
    reliefs.push_back(std::move(skin));
  });
}

namespace {

constexpr int columns = 5, rows = 7;

struct Glyph {
  char letter;
  std::array<std::uint8_t, rows> row;  // from the head down; bit 4 is the left column
};

constexpr Glyph glyphs[] = {
    {'A', {0b01110, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001}},
    {'B', {0b11110, 0b10001, 0b10001, 0b11110, 0b10001, 0b10001, 0b11110}},
    {'C', {0b01111, 0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b01111}},
    {'D', {0b11110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b11110}},
    {'E', {0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b11111}},
    {'F', {0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b10000}},
    {'G', {0b01111, 0b10000, 0b10000, 0b10111, 0b10001, 0b10001, 0b01111}},
    {'H', {0b10001, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001}},
    {'I', {0b11111, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b11111}},
    {'J', {0b00111, 0b00010, 0b00010, 0b00010, 0b00010, 0b10010, 0b01100}},
    {'K', {0b10001, 0b10011, 0b10110, 0b11100, 0b10110, 0b10011, 0b10001}},
    {'L', {0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b11111}},
    {'M', {0b10001, 0b11011, 0b11111, 0b10101, 0b10001, 0b10001, 0b10001}},
    {'N', {0b10001, 0b11001, 0b11101, 0b10111, 0b10011, 0b10001, 0b10001}},
    {'O', {0b01110, 0b11011, 0b10001, 0b10001, 0b10001, 0b11011, 0b01110}},
    {'P', {0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000, 0b10000}},
    {'Q', {0b01110, 0b11011, 0b10001, 0b10001, 0b10111, 0b11011, 0b01111}},
    {'R', {0b11110, 0b10001, 0b10001, 0b11110, 0b10110, 0b10011, 0b10001}},
    {'S', {0b01111, 0b10000, 0b10000, 0b01110, 0b00001, 0b00001, 0b11110}},
    {'T', {0b11111, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100}},
    {'U', {0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110}},
    {'V', {0b10001, 0b10001, 0b11011, 0b01010, 0b01110, 0b00100, 0b00100}},
    {'W', {0b10001, 0b10001, 0b10001, 0b10101, 0b11111, 0b11011, 0b10001}},
    {'X', {0b10001, 0b11011, 0b01110, 0b00100, 0b01110, 0b11011, 0b10001}},
    {'Y', {0b10001, 0b11011, 0b01110, 0b00100, 0b00100, 0b00100, 0b00100}},
    {'Z', {0b11111, 0b00011, 0b00110, 0b00100, 0b01100, 0b11000, 0b11111}},
    {'0', {0b01110, 0b11011, 0b10001, 0b10001, 0b10001, 0b11011, 0b01110}},
    {'1', {0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110}},
    {'2', {0b01110, 0b10001, 0b00011, 0b00110, 0b01100, 0b11000, 0b11111}},
    {'3', {0b11110, 0b00001, 0b00001, 0b01110, 0b00001, 0b00001, 0b11110}},
    {'4', {0b00110, 0b01110, 0b11010, 0b10010, 0b11111, 0b00010, 0b00010}},
    {'5', {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110}},
    {'6', {0b01110, 0b10000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110}},
    {'7', {0b11111, 0b00001, 0b00011, 0b00110, 0b00100, 0b01100, 0b01000}},
    {'8', {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110}},
    {'9', {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00001, 0b01110}},
};

using Raster = std::array<std::array<bool, columns>, rows>;

Raster raster_of(const Glyph& glyph) {
  Raster raster{};
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) raster[y][x] = ((glyph.row[y] >> (columns - 1 - x)) & 1) != 0;
  return raster;
}

// A rectangle of filled cells that starts at (x, y): take_bar() grows it to the right first unless
// `tall_first`, then down, and clears its cells.
struct Bar {
  std::size_t x0, y0, x1, y1;  // past the end
};
Bar take_bar(Raster& raster, std::size_t x, std::size_t y, bool tall_first) {
  Bar bar{x, y, x + 1, y + 1};
  const auto filled = [&](std::size_t x0, std::size_t x1, std::size_t at) {
    for (std::size_t k = x0; k < x1; ++k)
      if (!raster[at][k]) return false;
    return true;
  };
  if (!tall_first)
    while (bar.x1 < columns && raster[y][bar.x1]) ++bar.x1;
  while (bar.y1 < rows && filled(bar.x0, bar.x1, bar.y1)) ++bar.y1;
  for (std::size_t j = bar.y0; j < bar.y1; ++j)
    for (std::size_t i = bar.x0; i < bar.x1; ++i) raster[j][i] = false;
  return bar;
}

}  // namespace

std::optional<contact::Shape> letter_shape(const std::string& text, const Vec3& size) {
  if (text.size() != 1) return std::nullopt;
  for (const Glyph& glyph : glyphs) {
    if (glyph.letter != text[0]) continue;
    Raster raster = raster_of(glyph);
    std::vector<contact::CompoundChild> children;
    const Vec3 cell(size.x() / columns, size.y(), size.z() / rows);
    for (std::size_t y = 0; y < rows; ++y) {
      for (std::size_t x = 0; x < columns; ++x) {
        if (!raster[y][x]) continue;
        const bool tall = x + 1 == columns || !raster[y][x + 1];
        const Bar bar = take_bar(raster, x, y, tall);
        const Vec3 low(double(bar.x0), -0.5, double(bar.y0)), high(double(bar.x1), 0.5, double(bar.y1));
        const Vec3 middle = 0.5 * (low + high) - Vec3(0.5 * columns, 0, 0.5 * rows);
        children.push_back({contact::Box{0.5 * (high - low).cwiseProduct(cell)},
                            {middle.cwiseProduct(cell), Quat::Identity()}});
      }
    }
    return contact::make_compound(std::move(children));
  }
  return std::nullopt;
}

}  // namespace intaglio::scene
