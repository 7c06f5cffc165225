#include "sound/bake/fem/netgen_files.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace intaglio::sound {

namespace {

constexpr double volume_tolerance = 0.05;  // of the body's
constexpr double min_tet_volume = 1e-9;    // over the longest edge cubed

// Parser of whitespace-separated numbers with a sticky error flag.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : text_(text) {}
  template <class T>
  T next() {
    text_.remove_prefix(std::min(text_.find_first_not_of(" \n"), text_.size()));
    T value{};
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    is_broken_ |= error != std::errc{};
    text_.remove_prefix(std::size_t(end - text_.data()));
    return value;
  }
  bool is_broken() const { return is_broken_; }

 private:
  std::string_view text_;
  bool is_broken_ = false;
};

}  // namespace

std::string netgen_request(const BodySurface& body, double size) {
  std::string text =
      fmt::format("intaglio-netgen 1\n{} {} {}\n", size, body.points.size(), body.triangles.size());
  for (const Vec3& p : body.points) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : body.triangles) text += fmt::format("{} {} {}\n", a, b, c);
  return text;
}

Result<CornerMesh> parse_netgen_result(std::string_view text, const std::string& program) {
  constexpr std::string_view head = "intaglio-tetrahedra 1\n";
  const auto broken = [&] { return fail(program, "returned an unreadable mesh"); };
  if (!text.starts_with(head)) return broken();
  Numbers numbers(text.substr(head.size()));
  const auto points = numbers.next<long>(), tets = numbers.next<long>();
  // A point takes six characters at least, a tetrahedron eight.
  if (numbers.is_broken() || points < 4 || tets < 1 || points > long(text.size()) || tets > long(text.size()))
    return broken();
  CornerMesh mesh;
  for (long k = 0; k < points; ++k) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = numbers.next<double>();
    if (numbers.is_broken() || !p.allFinite()) return broken();
    mesh.points.push_back(p);
  }
  for (long k = 0; k < tets; ++k) {
    std::array<int, 4> tet{};
    for (int& corner : tet) {
      corner = numbers.next<int>();
      if (numbers.is_broken() || corner < 0 || corner >= points) return broken();
    }
    mesh.tets.push_back(tet);
  }
  return mesh;
}

bool fills(const CornerMesh& mesh, const BodySurface& body) {
  double sum = 0;
  std::map<std::array<int, 3>, int> uses;
  for (const auto& t : mesh.tets) {
    const auto at = [&](std::size_t k) -> const Vec3& { return mesh.points[std::size_t(t[k])]; };
    const double v = std::abs(signed_volume(mesh.points, t));
    double longest = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, (at(a) - at(b)).norm());
      std::array<int, 3> face{t[(a + 1) % 4], t[(a + 2) % 4], t[(a + 3) % 4]};
      std::sort(face.begin(), face.end());
      if (++uses[face] > 2) return false;
    }
    if (!(v > min_tet_volume * longest * longest * longest)) return false;
    sum += v;
  }
  return std::abs(sum / body.volume - 1) < volume_tolerance;
}

}  // namespace intaglio::sound
