#include "intaglio/sound/fem/solid_shape.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "intaglio/sound/fem/shapes.h"

namespace intaglio::sound {

namespace {

constexpr double smallest = 1e-4, largest = 100;  // metres

struct Named {
  const char* name;
  SolidShape::Kind kind;
  std::vector<char> keys;
  const char* example;
};

const std::array<Named, 4>& known_shapes() {
  static const std::array<Named, 4> all{
      {{"sphere", SolidShape::Kind::sphere, {'r'}, "sphere:r=0.05"},
       {"box", SolidShape::Kind::box, {'x', 'y', 'z'}, "box:x=0.3,y=0.01,z=0.2"},
       {"plate", SolidShape::Kind::box, {'a', 't'}, "plate:a=0.3,t=0.01"},
       {"cylinder", SolidShape::Kind::cylinder, {'r', 'h'}, "cylinder:r=0.02,h=0.2"}}};
  return all;
}

const Named* find(const std::string& text) {
  const std::string name = text.substr(0, text.find(':'));
  for (const Named& shape : known_shapes()) {
    if (text.find(':') != std::string::npos && name == shape.name) return &shape;
  }
  return nullptr;
}

Vec3 size_of(const Named& shape, const std::vector<double>& v) {
  switch (shape.kind) {
    case SolidShape::Kind::sphere:
      return Vec3::Constant(2 * v[0]);
    case SolidShape::Kind::cylinder:
      return {2 * v[0], v[1], 2 * v[0]};
    default:
      return v.size() == 2 ? Vec3(v[0], v[1], v[0]) : Vec3(v[0], v[1], v[2]);
  }
}

}  // namespace

bool is_solid_shape(const std::string& text) {
  return find(text) != nullptr;
}

Result<SolidShape> solid_shape(const std::string& text) {
  const Named* const shape = find(text);
  if (!shape)
    return fail(text, "is no built-in shape", "sphere, box, plate or cylinder, as in sphere:r=0.05");
  const std::string fix =
      fmt::format("write it like {}, sizes between {} and {} m", shape->example, smallest, largest);
  std::vector<double> values(shape->keys.size(), 0);
  std::string_view rest = std::string_view(text).substr(text.find(':') + 1);
  while (!rest.empty()) {
    const std::string_view part = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    const auto key =
        part.empty() ? shape->keys.end() : std::find(shape->keys.begin(), shape->keys.end(), part[0]);
    if (key == shape->keys.end() || part.size() < 3 || part[1] != '=')
      return fail(text, fmt::format("\"{}\" is not understood", part), fix);
    double& value = values[std::size_t(key - shape->keys.begin())];
    if (value != 0) return fail(text, fmt::format("{} is given twice", *key), fix);
    const auto [end, error] = std::from_chars(part.data() + 2, part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || !(value >= smallest && value <= largest))
      return fail(text, fmt::format("\"{}\" is no size", part), fix);
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] == 0) return fail(text, fmt::format("{} is missing", shape->keys[k]), fix);
  }
  return SolidShape{shape->kind, size_of(*shape, values)};
}

double SolidShape::volume() const {
  const double full = size.prod();
  if (kind == Kind::sphere) return std::numbers::pi / 6 * full;
  return kind == Kind::cylinder ? std::numbers::pi / 4 * full : full;
}

double SolidShape::area() const {
  constexpr double pi = std::numbers::pi;
  if (kind == Kind::sphere) return pi * size.x() * size.x();
  if (kind == Kind::cylinder) return pi * size.x() * size.y() + 0.5 * pi * size.x() * size.x();
  return 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
}

TetMesh SolidShape::mesh(double element_size, int max_elements) const {
  for (double h = element_size;; h *= 1.1) {
    const auto count = [&](double extent, int least) {
      return std::max(least, int(std::ceil(std::min(extent / h, 1e6))));
    };
    if (kind == Kind::sphere) {
      const int level = std::clamp(int(std::ceil(std::log2(0.5 * size.x() / h))), 1, 8);
      if (level == 1 || 20 * std::pow(8, level) <= max_elements) return ball(0.5 * size.x(), level);
    } else if (kind == Kind::cylinder) {
      const int rings = count(0.5 * size.x(), 2), layers = count(size.y(), 1);
      if (h > size.maxCoeff() || 18.0 * rings * rings * layers <= max_elements)
        return cylinder(0.5 * size.x(), size.y(), rings, layers);
    } else {
      // One layer of quadratic elements bends well if they are no wider than it is thick.
      const auto even = [&](double extent) {
        return extent >= h && extent < 1.5 * h ? 1 : (count(extent, 2) + 1) / 2 * 2;
      };
      const int nx = even(size.x()), ny = even(size.y()), nz = even(size.z());
      if (h > size.maxCoeff() || 6.0 * nx * ny * nz <= max_elements) return box(size, nx, ny, nz);
    }
  }
}

}  // namespace intaglio::sound
