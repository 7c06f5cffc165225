// STL: triangles and nothing else. Binary files have 80 bytes of anything, a count, and 50 bytes a triangle;
// ASCII files may start with the same word as a binary header, so the length decides.
#include <charconv>
#include <cmath>
#include <cstring>

#include "intaglio/surface/mesh/mesh_file.h"

namespace intaglio::surface {

namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

// The words of the text one by one, with the line that each is on.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  // Empty at the end.
  std::string_view next() {
    while (at_ < text_.size() && is_space(text_[at_])) line_ += text_[at_++] == '\n' ? 1u : 0u;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }
  std::size_t line() const { return line_; }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  std::string_view text_;
  std::size_t at_ = 0, line_ = 1;
};

void add_vertex(TriangleMesh& mesh, const Vec3& position) {
  mesh.positions.push_back(position);
  mesh.normals.emplace_back(Vec3::Zero());
  mesh.uvs.emplace_back(Vec2::Zero());
  const auto count = static_cast<int>(mesh.positions.size());
  if (count % 3 == 0) mesh.triangles.push_back({count - 3, count - 2, count - 1});
}

Result<TriangleMesh> read_binary(std::span<const std::uint8_t> bytes, std::size_t count,
                                 const std::string& name) {
  if (count > max_mesh_triangles)
    return fail(name, fmt::format("has {} triangles", count),
                fmt::format("at most {} are read", max_mesh_triangles));
  TriangleMesh mesh;
  for (std::size_t triangle = 0; triangle < count; ++triangle) {
    std::array<float, 9> corners;
    std::memcpy(corners.data(), bytes.data() + header_bytes + triangle * triangle_bytes + 12, sizeof corners);
    for (std::size_t k = 0; k < 9; k += 3)
      add_vertex(mesh, Vec3(double(corners[k]), double(corners[k + 1]), double(corners[k + 2])));
  }
  return checked(std::move(mesh), name);
}

Result<TriangleMesh> read_ascii(std::string_view text, const std::string& name) {
  TriangleMesh mesh;
  Words words(text);
  const auto fail_here = [&](std::string what, std::string fix = {}) {
    return fail(fmt::format("{}:{}", name, words.line()), std::move(what), std::move(fix));
  };
  if (words.next() != "solid") {
    return fail(
        name, "is not an STL file",
        "ASCII starts with \"solid\"; a binary file is 84 bytes and 50 more for each triangle it counts");
  }
  words.skip_line();  // the name, which may be anything
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word == "facet" && mesh.positions.size() % 3 != 0) return fail_here("a facet has not 3 corners");
    if (word == "endsolid" || word == "solid") words.skip_line();
    if (word != "vertex") continue;
    if (mesh.triangles.size() >= max_mesh_triangles)
      return fail_here("has too many triangles", fmt::format("at most {} are read", max_mesh_triangles));
    Vec3 position;
    for (double& value : position) {
      std::string_view number = words.next();
      if (number.starts_with('+')) number.remove_prefix(1);
      const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
      if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(value))
        return fail_here("a number of a vertex is missing or not finite");
    }
    add_vertex(mesh, position);
  }
  if (mesh.positions.size() % 3 != 0) return fail_here("ends within a facet", "is the file cut off?");
  return checked(std::move(mesh), name);
}

}  // namespace

Result<TriangleMesh> parse_stl(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.size() > max_mesh_file_bytes)
    return fail(name, fmt::format("has {} bytes", bytes.size()),
                fmt::format("at most {} are read", max_mesh_file_bytes));
  if (bytes.size() >= header_bytes) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    if (bytes.size() == header_bytes + triangle_bytes * std::size_t{count})
      return read_binary(bytes, count, name);
  }
  return read_ascii({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name);
}

}  // namespace intaglio::surface
