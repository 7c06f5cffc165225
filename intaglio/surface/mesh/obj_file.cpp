// Wavefront OBJ: v, vt, vn and f; the rest (groups, materials, lines, curves) is passed over.
#include <charconv>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "intaglio/surface/mesh/mesh_file.h"

namespace intaglio::surface {

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
      h = (h ^ static_cast<std::uint32_t>(index)) * 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }
};

class ObjParser {
 public:
  ObjParser(std::string name, MeshUse use) : name_(std::move(name)), use_(use) {}

  Result<TriangleMesh> parse(std::string_view text) {
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

  Result<void> read_line(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword != "v" && keyword != "vn" && keyword != "vt" && keyword != "f") return {};
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    if (line.ends_with('\\'))
      return fail_here("goes on in the next line", "write each statement on one line");
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

  // "7", counted from 1, or "-2", counted back from the last one so far.
  std::optional<int> to_index(std::string_view word, std::size_t count) const {
    int value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || value == 0) return std::nullopt;
    const std::int64_t index = value > 0 ? std::int64_t{value} - 1 : static_cast<std::int64_t>(count) + value;
    if (index < 0 || index >= static_cast<std::int64_t>(count)) return std::nullopt;
    return static_cast<int>(index);
  }

  // "position/uv" or "position/uv/normal"; without UVs also "position" or "position//normal".
  Result<Corner> to_corner(std::string_view word) const {
    std::array<std::string_view, 3> parts;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t end = k < 2 ? std::min(word.find('/'), word.size()) : word.size();
      parts[k] = word.substr(0, end);
      word.remove_prefix(std::min(end + 1, word.size()));
    }
    if (parts[1].empty() && use_ == MeshUse::texture)
      return fail_here("a face has no UVs", "a texture needs them; unwrap the mesh and export its UVs");
    const auto position = to_index(parts[0], positions_.size());
    const auto uv = parts[1].empty() ? std::optional(-1) : to_index(parts[1], uvs_.size());
    const auto normal = parts[2].empty() ? std::optional(-1) : to_index(parts[2], normals_.size());
    if (!position || !uv || !normal)
      return fail_here(fmt::format("a face names a {} that is not there", !position ? "position"
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

  int vertex(const Corner& corner) {
    const auto [at, is_new] = vertices_.try_emplace(corner, static_cast<int>(mesh_.positions.size()));
    if (is_new) {
      mesh_.positions.push_back(positions_[static_cast<std::size_t>(corner.position)]);
      mesh_.uvs.push_back(corner.uv < 0 ? Vec2(Vec2::Zero()) : uvs_[static_cast<std::size_t>(corner.uv)]);
      mesh_.normals.push_back(corner.normal < 0 ? Vec3(Vec3::Zero())
                                                : normals_[static_cast<std::size_t>(corner.normal)]);
    }
    return at->second;
  }

  std::string name_;
  MeshUse use_;
  std::size_t line_ = 0;
  std::size_t fans_ = 0;
  std::vector<Vec3> positions_, normals_;
  std::vector<Vec2> uvs_;
  std::unordered_map<Corner, int, CornerHash> vertices_;
  TriangleMesh mesh_;
};

}  // namespace

Result<TriangleMesh> parse_obj(std::string_view text, const std::string& name, MeshUse use) {
  if (text.size() > max_mesh_file_bytes)
    return fail(name, fmt::format("has {} bytes", text.size()),
                fmt::format("at most {} are read", max_mesh_file_bytes));
  return ObjParser(name, use).parse(text);
}

}  // namespace intaglio::surface
