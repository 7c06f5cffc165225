// Textures of a scene file, and the curved bases and bodies that they lie on.
#include <cmath>
#include <variant>

#include "intaglio/session/scene_reader.h"

namespace intaglio::session {

void read_texture(TomlReader& r, SurfaceScene& surface) {
  r.text("texture", surface.texture);
  surface.line = r.line_of("texture");
  if (r.has("green")) {
    int green = 0;
    r.choice("green", {"+Y", "-Y"}, green);
    surface.green = green == 0 ? surface::Green::plus_y : surface::Green::minus_y;
  } else {
    r.optional_key("green");
  }
  if (r.has("polarity")) {
    int polarity = 0;
    r.choice("polarity", {"depth", "height"}, polarity);
    surface.polarity = polarity == 0 ? surface::Polarity::depth : surface::Polarity::height;
  } else {
    r.optional_key("polarity");
  }
  int edge = static_cast<int>(surface.edge);
  r.choice("edge", {"wrap", "clamp"}, edge);
  surface.edge = static_cast<surface::Edge>(edge);
  if (r.has("depth")) {
    r.number("depth", surface.depth.emplace(), at_least_zero("depth must be between 0 m and 10 m", 10));
  } else {
    r.optional_key("depth");
  }
  int mode = static_cast<int>(surface.mode);
  r.choice("maps", {"fused", "raw"}, mode);
  surface.mode = static_cast<surface::ImportMode>(mode);
}

namespace {

void read_repeat(TomlReader& r, Vec2& repeat) {
  r.pair("repeat", repeat, {1, 64, false, "a texture can be repeated 1 to 64 times"});
  if (repeat != Vec2(std::floor(repeat.x()), std::floor(repeat.y())))
    r.fail_at("repeat", "a texture is repeated in part", "give whole numbers");
}

void only_keys_of_base(TomlReader& r, BaseScene::Shape shape) {
  const std::vector<const char*> all = {"radius", "height", "file", "repeat"};
  switch (shape) {
    case BaseScene::Shape::bowl:
      return r.only_keys("a bowl", {"radius", "repeat"}, all);
    case BaseScene::Shape::cylinder:
      return r.only_keys("a cylinder", {"radius", "height", "repeat"}, all);
    case BaseScene::Shape::sphere:
      return r.only_keys("a sphere", {"radius", "repeat"}, all);
    case BaseScene::Shape::mesh:
      return r.only_keys("a mesh", {"file", "repeat"}, all);
  }
}

// On the side of a box that its Y leaves by, or, upside down, comes in by.
SurfaceScene face_of(const contact::Box& box, bool bottom) {
  SurfaceScene face;
  face.size = {2 * box.half.x(), 2 * box.half.z()};
  face.position = {0, bottom ? -box.half.y() : box.half.y(), 0};
  face.rotation = {bottom ? 180.0 : 0.0, 0, 0};
  face.thickness = box.half.y();
  return face;
}

}  // namespace

void read_base(TomlReader& r, SurfaceScene& surface) {
  r.table("base", [&](TomlReader& reader) {
    BaseScene& base = surface.base.emplace();
    int shape = 0;
    reader.choice("shape", {"bowl", "cylinder", "sphere", "mesh"}, shape);
    base.shape = static_cast<BaseScene::Shape>(shape);
    reader.number("radius", base.radius, {0.01, 100, false, "a radius must be between 0.01 m and 100 m"});
    reader.number("height", base.height, {0.01, 100, false, "a height must be between 0.01 m and 100 m"});
    reader.text("file", base.file);
    read_repeat(reader, base.repeat);
    base.line = reader.line_of("file");
    only_keys_of_base(reader, base.shape);
    if (base.shape == BaseScene::Shape::mesh && base.file.empty())
      reader.fail_at("shape", "a mesh has no file", "give file = \"bowl.glb\", with texture coordinates");
  });
  if (surface.base) r.only_keys("a ground with a base", {"base"}, {"size"});
}

void read_reliefs(TomlReader& r, const contact::Shape& shape, std::vector<SurfaceScene>& reliefs) {
  const auto* box = std::get_if<contact::Box>(&shape);
  const auto* ball = std::get_if<contact::Sphere>(&shape);
  const auto read_face = [&](TomlReader& t, bool bottom) {
    SurfaceScene face = face_of(box == nullptr ? contact::Box{Vec3::Ones()} : *box, bottom);
    read_texture(t, face);
    reliefs.push_back(std::move(face));
  };
  for (const char* side : {"top", "bottom"})
    if (box == nullptr && r.has(side))
      r.fail_at(side, std::string("this body has no ") + side, "a box has; a sphere may have a skin");
  r.table("top", [&](TomlReader& t) { read_face(t, false); });
  r.table("bottom", [&](TomlReader& t) { read_face(t, true); });
  if (ball == nullptr && r.has("skin"))
    r.fail_at("skin", "this body has no skin", "a sphere has; a box may have a top and a bottom");
  r.table("skin", [&](TomlReader& t) {
    SurfaceScene skin;
    BaseScene& base = skin.base.emplace();
    base.shape = BaseScene::Shape::sphere;
    base.radius = ball == nullptr ? 1 : ball->radius;
    read_texture(t, skin);
    read_repeat(t, base.repeat);
    base.line = t.line_of("texture");
    reliefs.push_back(std::move(skin));
  });
}

}  // namespace intaglio::session
