#include "mesh/mesh_file.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "core/file.h"

namespace intaglio::surface {

namespace fs = std::filesystem;

namespace {

// Follows links before the comparison: one that leads out of the folder is as bad as "..".
bool lies_within(const fs::path& folder, const fs::path& path) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(path, error);
  if (error) return false;
  const fs::path outer = fs::canonical(folder, error);
  if (error) return false;
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

BufferLoader loader_beside(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return [folder, name = path.string()](const std::string& uri,
                                        std::size_t limit) -> Result<std::vector<std::uint8_t>> {
    const fs::path side = folder / uri;
    if (fs::path(uri).is_absolute() || !lies_within(folder, side))
      return fail(name, "refers to the buffer " + uri + ", outside its folder",
                  "buffers must lie beside the file");
    return read_file(side, limit);  // Fuzzed by fuzz/gltf.cpp through parse_gltf
  };
}

}  // namespace

Result<void> check_mesh_file_size(std::size_t bytes, const std::string& name) {
  if (bytes <= max_mesh_file_bytes) return {};
  return fail(name, fmt::format("has {} bytes", bytes),
              fmt::format("at most {} are read", max_mesh_file_bytes));
}

namespace {

// Reading and repairing them (triangle_mesh.cpp, checked), and finding the body that they enclose, or laying
// a texture on them.
double mesh_bytes(std::size_t vertices, std::size_t triangles) {
  return 160 * double(vertices) + 250 * double(triangles);
}

}  // namespace

Result<void> check_mesh_memory(const std::string& name, std::size_t vertices, std::size_t triangles,
                               std::uint64_t allowed) {
  return check_memory(name, {"mesh", mesh_bytes(vertices, triangles)}, allowed);
}

Result<TriangleMesh> read_mesh(const fs::path& path, const MeshOptions& options) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const bool gltf = extension == ".gltf" || extension == ".glb";
  const bool stl = extension == ".stl";
  if (!gltf && !stl && extension != ".obj")
    return fail(path.string(), "is not a mesh file that can be read",
                options.use == MeshUse::shape ? "use .obj, .stl, .gltf or .glb" : "use .obj, .gltf or .glb");
  if (stl && options.use == MeshUse::texture)
    return fail(path.string(), "is an STL file, which has no UVs",
                "a texture needs them; use .obj, .gltf or .glb");
  const auto bytes = read_file(path, max_mesh_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  if (gltf) return parse_gltf(*bytes, path.string(), loader_beside(path), options);
  if (stl) return parse_stl(*bytes, path.string(), options);
  return parse_obj({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, path.string(), options);
}

// Wavefront OBJ: v, vt, vn and f; the rest (groups, materials, lines, curves) is ignored.

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

// Takes the next word off the front of `line`; empty at its end.
std::string_view take_word(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

std::optional<double> to_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// Position, UV and normal of a corner: indices from 0; -1 when it has none.
struct Corner {
  int position = -1, uv = -1, normal = -1;
  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const int index : {c.position, c.uv, c.normal}) {
      h = (h ^ std::uint32_t(index)) * 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return std::size_t(h);
  }
};

class ObjParser {
 public:
  ObjParser(std::string name, const MeshOptions& options) : name_(std::move(name)), options_(options) {}

  Result<TriangleMesh> parse(std::string_view text) {
    if (auto fits = reserve_lists(text); !fits) return tl::unexpected(fits.error());
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      ++line_;
      if (auto read = read_line(text.substr(0, end)); !read) return tl::unexpected(read.error());
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    if (fans_ > 0)
      mesh_.notes.push_back(fmt::format("{} polygons with more than 4 corners were cut into fans", fans_));
    return checked(std::move(mesh_), name_);
  }

 private:
  tl::unexpected<Error> fail_here(std::string what, std::string fix = {}) const {
    return fail(fmt::format("{}:{}", name_, line_), std::move(what), std::move(fix));
  }

  // Counts the lines, so that the lists of positions, normals and UVs never grow.
  Result<void> reserve_lists(std::string_view text) {
    std::size_t positions = 0, normals = 0, uvs = 0, faces = 0;
    for (std::size_t at = 0; at < text.size(); at = std::min(text.find('\n', at), text.size()) + 1) {
      if (text[at] == 'f') ++faces;
      if (text[at] != 'v' || at + 1 == text.size()) continue;
      ++(text[at + 1] == 'n' ? normals : text[at + 1] == 't' ? uvs : positions);
    }
    MemoryCost cost("text", double(text.size()));
    cost.add("mesh", mesh_bytes(std::min(positions, 3 * faces), faces));  // at least
    cost.add("lists", double(sizeof(Vec3) * (positions + normals) + sizeof(Vec2) * uvs));
    if (auto fits = check_memory(name_, cost, options_.allowed_memory); !fits) return fits;
    positions_.reserve(positions);
    normals_.reserve(normals);
    uvs_.reserve(uvs);
    return {};
  }

  Result<void> read_line(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword != "v" && keyword != "vn" && keyword != "vt" && keyword != "f") return {};
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    if (line.ends_with('\\'))
      return fail_here("uses line continuation, which is not supported", "write each statement on one line");
    if (keyword == "v") return read_vector(line, positions_, "a position");
    if (keyword == "vn") return read_vector(line, normals_, "a normal");
    if (keyword == "vt") return read_vector(line, uvs_, "a UV");
    return read_face(line);
  }

  template <class Vector>
  Result<void> read_vector(std::string_view line, std::vector<Vector>& vectors, const char* what) {
    Vector vector;
    for (Eigen::Index k = 0; k < vector.size(); ++k) {
      const auto number = to_number(take_word(line));
      if (!number) return fail_here(fmt::format("number {} of {} is missing or not finite", k + 1, what));
      vector[k] = *number;
    }
    vectors.push_back(vector);
    return {};
  }

  // "7", counted from 1, or "-2", relative to the last one read.
  std::optional<int> to_index(std::string_view word, std::size_t count) const {
    int value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || value == 0) return std::nullopt;
    const std::int64_t index = value > 0 ? std::int64_t{value} - 1 : std::int64_t(count) + value;
    if (index < 0 || index >= std::int64_t(count)) return std::nullopt;
    return int(index);
  }

  // "position/uv" or "position/uv/normal"; without UVs also "position" or "position//normal".
  Result<Corner> to_corner(std::string_view word) const {
    std::array<std::string_view, 3> parts;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t end = k < 2 ? std::min(word.find('/'), word.size()) : word.size();
      parts[k] = word.substr(0, end);
      word.remove_prefix(std::min(end + 1, word.size()));
    }
    if (parts[1].empty() && options_.use == MeshUse::texture)
      return fail_here("a face has no UVs", "a texture needs them; unwrap the mesh and export its UVs");
    const auto position = to_index(parts[0], positions_.size());
    const auto uv = parts[1].empty() ? std::optional(-1) : to_index(parts[1], uvs_.size());
    const auto normal = parts[2].empty() ? std::optional(-1) : to_index(parts[2], normals_.size());
    if (!position || !uv || !normal)
      return fail_here(fmt::format("a face refers to a missing {}", !position ? "position"
                                                                    : !uv     ? "UV"
                                                                              : "normal"),
                       fmt::format("so far there are {} positions, {} UVs and {} normals", positions_.size(),
                                   uvs_.size(), normals_.size()));
    return Corner{*position, *uv, *normal};
  }

  Result<void> read_face(std::string_view line) {
    std::array<int, 3> fan{};  // the first corner, the one before, this one
    std::size_t corners = 0;
    for (std::string_view word = take_word(line); !word.empty() && word.front() != '#';
         word = take_word(line)) {
      const auto corner = to_corner(word);
      if (!corner) return tl::unexpected(corner.error());
      fan[std::min<std::size_t>(corners, 2)] = vertex(*corner);
      if (auto fits = check_growth(); !fits) return fits;
      if (++corners < 3) continue;
      if (mesh_.triangles.size() >= max_mesh_triangles)
        return fail_here("has too many triangles", fmt::format("at most {} are read", max_mesh_triangles));
      mesh_.triangles.push_back(fan);
      fan[1] = fan[2];
    }
    if (corners < 3)
      return fail_here(fmt::format("a face has {} corners", corners), "a face needs 3 or more");
    if (corners > 4) ++fans_;
    return {};
  }

  // Only reading tells how many different corners there are: checked at every 65536th.
  Result<void> check_growth() const {
    constexpr std::size_t stride = 1 << 16;
    const std::size_t vertices = mesh_.positions.size();
    if (vertices % stride != 0) return {};
    return check_mesh_memory(name_, vertices + stride, mesh_.triangles.size(), options_.allowed_memory);
  }

  int vertex(const Corner& corner) {
    const auto [at, is_new] = vertices_.try_emplace(corner, int(mesh_.positions.size()));
    if (is_new) {
      mesh_.positions.push_back(positions_[std::size_t(corner.position)]);
      mesh_.uvs.push_back(corner.uv < 0 ? Vec2(Vec2::Zero()) : uvs_[std::size_t(corner.uv)]);
      mesh_.normals.push_back(corner.normal < 0 ? Vec3(Vec3::Zero()) : normals_[std::size_t(corner.normal)]);
    }
    return at->second;
  }

  std::string name_;
  MeshOptions options_;
  std::size_t line_ = 0;
  std::size_t fans_ = 0;
  std::vector<Vec3> positions_, normals_;
  std::vector<Vec2> uvs_;
  std::unordered_map<Corner, int, CornerHash> vertices_;
  TriangleMesh mesh_;
};

}  // namespace

Result<TriangleMesh> parse_obj(std::string_view text, const std::string& name, const MeshOptions& options) {
  if (auto size = check_mesh_file_size(text.size(), name); !size) return tl::unexpected(size.error());
  return ObjParser(name, options).parse(text);
}

// STL: triangles and nothing else. Binary files have an 80-byte header, a count, and 50 bytes a triangle;
// ASCII files may start with the same word as a binary header, so the length decides.

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
  const auto count = int(mesh.positions.size());
  if (count % 3 == 0) mesh.triangles.push_back({count - 3, count - 2, count - 1});
}

Result<TriangleMesh> read_binary(std::span<const std::uint8_t> bytes, std::size_t count,
                                 const std::string& name, const MeshOptions& options) {
  if (count > max_mesh_triangles)
    return fail(name, fmt::format("has {} triangles", count),
                fmt::format("at most {} are read", max_mesh_triangles));
  if (auto fits = check_mesh_memory(name, 3 * count, count, options.allowed_memory); !fits)
    return tl::unexpected(fits.error());
  TriangleMesh mesh;
  for (std::size_t triangle = 0; triangle < count; ++triangle) {
    std::array<float, 9> corners;
    std::memcpy(corners.data(), bytes.data() + header_bytes + triangle * triangle_bytes + 12, sizeof corners);
    for (std::size_t k = 0; k < 9; k += 3)
      add_vertex(mesh, Vec3(double(corners[k]), double(corners[k + 1]), double(corners[k + 2])));
  }
  return checked(std::move(mesh), name);
}

Result<TriangleMesh> read_ascii(std::string_view text, const std::string& name, const MeshOptions& options) {
  TriangleMesh mesh;
  Words words(text);
  const auto fail_here = [&](std::string what, std::string fix = {}) {
    return fail(fmt::format("{}:{}", name, words.line()), std::move(what), std::move(fix));
  };
  if (words.next() != "solid") {
    return fail(name, "is not an STL file",
                "ASCII starts with \"solid\"; a binary file with n triangles has exactly 84 + 50 n bytes");
  }
  words.skip_line();  // the name, which may be anything
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word == "facet" && mesh.positions.size() % 3 != 0)
      return fail_here("a facet does not have 3 vertices");
    if (word == "endsolid" || word == "solid") words.skip_line();
    if (word != "vertex") continue;
    if (mesh.triangles.size() >= max_mesh_triangles)
      return fail_here("has too many triangles", fmt::format("at most {} are read", max_mesh_triangles));
    Vec3 position;
    for (double& value : position) {
      const auto number = to_number(words.next());
      if (!number) return fail_here("a number of a vertex is missing or not finite");
      value = *number;
    }
    add_vertex(mesh, position);
    if (mesh.positions.size() % (1 << 16) != 0) continue;
    if (auto fits =
            check_mesh_memory(name, mesh.positions.size(), mesh.triangles.size(), options.allowed_memory);
        !fits)
      return tl::unexpected(fits.error());
  }
  if (mesh.positions.size() % 3 != 0) return fail_here("ends within a facet", "is the file cut off?");
  return checked(std::move(mesh), name);
}

}  // namespace

Result<TriangleMesh> parse_stl(std::span<const std::uint8_t> bytes, const std::string& name,
                               const MeshOptions& options) {
  if (auto size = check_mesh_file_size(bytes.size(), name); !size) return tl::unexpected(size.error());
  if (bytes.size() >= header_bytes) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    if (bytes.size() == header_bytes + triangle_bytes * std::size_t{count})
      return read_binary(bytes, count, name, options);
  }
  return read_ascii({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name, options);
}

}  // namespace intaglio::surface
