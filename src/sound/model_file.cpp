#include "sound/model_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

#include "core/file.h"
#include "model_generated.h"

namespace intaglio::sound {

namespace {

constexpr std::size_t max_file_bytes = 256u << 20;
constexpr int model_version = 3;
constexpr double max_coordinate = 1e6;  // metres

Material material_of(const file::Elasticity& from) {
  Material material;
  material.name = from.name() ? from.name()->str() : "";
  material.density = from.density();
  material.youngs_modulus = from.youngs_modulus();
  material.poisson_ratio = from.poisson_ratio();
  material.rayleigh_alpha = from.rayleigh_alpha();
  material.rayleigh_beta = from.rayleigh_beta();
  material.friction = from.friction();
  material.restitution = from.restitution();
  material.rolling_resistance = from.rolling_resistance();
  material.micro = {from.rms_height(), from.correlation_length(), from.spectral_slope()};
  return material;
}

// The verifier checks where a list begins, but not that its elements are aligned: bytes are copied, not read.
static_assert(FLATBUFFERS_LITTLEENDIAN, "the lists of a model file are read as they are");
template <class T, class List>
std::vector<T> copied(const List& list) {
  std::vector<T> values(list.size());
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), list.Data(), values.size() * sizeof(T));
  return values;
}

bool is_finite(const Material& m) {
  const auto numbers = {m.density,
                        m.youngs_modulus,
                        m.poisson_ratio,
                        m.rayleigh_alpha,
                        m.rayleigh_beta,
                        m.friction,
                        m.restitution,
                        m.rolling_resistance,
                        m.micro.rms_height,
                        m.micro.correlation_length,
                        m.micro.spectral_slope};
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

Result<void> check_modes(const ModalModel& model, const std::string& name) {
  const std::size_t count = model.angular_frequency.size();
  if (model.damping.size() != count || model.radiation.size() != count)
    return fail(name, "its lists of modes have different lengths");
  double last = 0;
  for (std::size_t m = 0; m < count; ++m) {
    const double omega = model.angular_frequency[m], d = model.damping[m];
    if (!(omega >= last && omega > 0 && omega < 1e9 && d >= 0 && d < omega &&
          std::abs(model.radiation[m]) < 1e6))
      return fail(name, fmt::format("mode {} does not ring, or is out of order", m));
    last = omega;
  }
  if (!is_finite(model.material) || !(model.mass > 0 && std::isfinite(model.mass)) ||
      !(model.area > 0 && std::isfinite(model.area)) || !std::isfinite(model.residual) ||
      !std::isfinite(model.shape_error) || !std::isfinite(model.merge_error_db) ||
      !std::isfinite(model.merge_error_rms_db) || model.modes_found < 0)
    return fail(name, "its material, mass or area is not a number that can be");
  return {};
}

Result<void> check_surface(const ModalModel& model, const std::string& name) {
  if (model.points.empty() || model.triangles.empty()) return fail(name, "has no surface");
  if (model.shapes.size() != 3 * model.points.size() * model.angular_frequency.size())
    return fail(name, "its shapes are not one of each mode for each point");
  const Vec3 middle = model.points.front();
  if (std::all_of(model.points.begin(), model.points.end(),
                  [&](const Vec3& p) { return (p - middle).norm() < 1e-6; }))
    return fail(name, "its surface is a point");
  const auto within = [](const Vec3& p) { return (p.array().abs() <= max_coordinate).all(); };
  if (!std::all_of(model.points.begin(), model.points.end(), within))
    return fail(name, fmt::format("a point is not finite or beyond {} m", max_coordinate));
  for (const Triangle& t : model.triangles) {
    for (const int p : t) {
      if (p < 0 || std::size_t(p) >= model.points.size())
        return fail(name, fmt::format("a triangle names point {} of {}", p, model.points.size()));
    }
  }
  if (!std::all_of(model.shapes.begin(), model.shapes.end(), [](float x) { return std::isfinite(x); }))
    return fail(name, "a mode shape is not finite");
  return {};
}

}  // namespace

std::vector<std::uint8_t> model_bytes(const ModalModel& model) {
  flatbuffers::FlatBufferBuilder builder;
  std::vector<file::Point> points;
  for (const Vec3& p : model.points) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<file::Face> faces;
  for (const auto& [a, b, c] : model.triangles) faces.emplace_back(a, b, c);
  const Material& m = model.material;
  const auto material = file::CreateElasticity(
      builder, builder.CreateString(m.name), m.density, m.youngs_modulus, m.poisson_ratio, m.rayleigh_alpha,
      m.rayleigh_beta, m.friction, m.restitution, m.rolling_resistance, m.micro.rms_height,
      m.micro.correlation_length, m.micro.spectral_slope);
  const auto name = builder.CreateString(model.name), source = builder.CreateString(model.source);
  const auto frequency = builder.CreateVector(model.angular_frequency);
  const auto damping = builder.CreateVector(model.damping);
  const auto radiation = builder.CreateVector(model.radiation);
  const auto point_list = builder.CreateVectorOfStructs(points);
  const auto face_list = builder.CreateVectorOfStructs(faces);
  const std::vector<float> units = shape_units(model);
  const std::vector<std::int16_t> rounded = rounded_shapes(model, units);
  const auto shapes = builder.CreateVector(rounded);
  const auto shape_units = builder.CreateVector(units);
  file::FinishModelBuffer(
      builder,
      file::CreateModel(builder, name, material, model.mass, model.area, model.residual, frequency, damping,
                        radiation, point_list, face_list, shapes, model.shape_error, source, model_version,
                        model.modes_found, model.merge_error_db, model.merge_error_rms_db, shape_units));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

Result<ModalModel> parse_model(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.size() > max_file_bytes)
    return fail(name, fmt::format("has {} bytes", bytes.size()),
                fmt::format("at most {} are read", max_file_bytes));
  // The verifier wants aligned numbers, which a span need not hold.
  const std::vector<std::uint8_t> aligned(bytes.begin(), bytes.end());
  flatbuffers::Verifier verifier(aligned.data(), aligned.size());
  if (aligned.size() < 16 || !file::VerifyModelBuffer(verifier))
    return fail(name, "is not a modal model, or is cut off",
                "bake it again: intaglio bake MESH --material M -o MODEL");
  const file::Model& from = *file::GetModel(aligned.data());
  if (from.version() != model_version)
    return fail(name,
                fmt::format("is of format {}, and this program reads {}", from.version(), model_version),
                "bake it again: intaglio bake MESH --material M -o MODEL");
  ModalModel model;
  model.name = from.name() ? from.name()->str() : "";
  model.material = material_of(*from.material());
  model.mass = from.mass();
  model.area = from.area();
  model.residual = from.residual();
  model.source = from.source() ? from.source()->str() : "";
  model.shape_error = from.shape_error();
  model.modes_found = from.modes_found();
  model.merge_error_db = from.merge_error_db();
  model.merge_error_rms_db = from.merge_error_rms_db();
  model.angular_frequency = copied<double>(*from.angular_frequency());
  model.damping = copied<double>(*from.damping());
  model.radiation = copied<double>(*from.radiation());
  for (const file::Point& p : copied<file::Point>(*from.points()))
    model.points.emplace_back(p.x(), p.y(), p.z());
  for (const file::Face& f : copied<file::Face>(*from.triangles()))
    model.triangles.push_back({f.a(), f.b(), f.c()});
  const std::vector<std::int16_t> rounded = copied<std::int16_t>(*from.shapes());
  const std::vector<float> units =
      from.shape_unit() ? copied<float>(*from.shape_unit()) : std::vector<float>();
  if (units.size() != model.angular_frequency.size() ||
      (!units.empty() && rounded.size() % units.size() != 0))
    return fail(name, "its shapes have not one unit for each mode", "bake it again");
  if (!std::all_of(units.begin(), units.end(), [](float u) { return u >= 0x1p-120f && u <= 0x1p120f; }))
    return fail(name, "a unit of its shapes is not a number that can be", "bake it again");
  model.shapes.reserve(rounded.size());
  for (auto whole = rounded.begin(); whole != rounded.end() && !units.empty();) {
    for (const float unit : units) model.shapes.push_back(float(*whole++) * unit);
  }
  if (auto sound = check_modes(model, name); !sound) return tl::unexpected(sound.error());
  if (auto sound = check_surface(model, name); !sound) return tl::unexpected(sound.error());
  model.grid = TriangleGrid(model.points, model.triangles);
  return model;
}

Result<void> write_model(const std::filesystem::path& path, const ModalModel& model) {
  if (auto sound = check_modes(model, path.string()); !sound) return sound;
  return write_file(path, model_bytes(model));
}

Result<ModalModel> read_model(const std::filesystem::path& path) {
  const auto bytes = read_file(path, max_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_model(*bytes, path.string());
}

}  // namespace intaglio::sound
