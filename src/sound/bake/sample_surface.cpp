#include "sound/bake/sample_surface.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "sound/bake/fem/modes.h"

namespace intaglio::sound {

namespace {

constexpr int probed_groups = 16;  // groups of equal frequency whose shapes are tested during simplification
constexpr int max_probed = 48;     // modes, or one group more
constexpr double min_normal_cosine = 0.3;  // cosine between a triangle's normals before and after
constexpr double min_face_quality = 0.05;  // of a triangle: twice its area over its longest edge squared

using Probe = Eigen::VectorXf;  // of a point: x, y, z of every probed mode, over its group's largest

// Range of a probe that belongs to one group of equal frequency. Groups are measured as a whole, so that the
// basis of their modes does not matter.
struct Segment {
  Eigen::Index first, size;
};

struct Probes {
  std::vector<Segment> segments;
  std::vector<Probe> of_point;
};

// Shapes of the modes with the shortest waves, and of some others.
Probes make_probes(const ModalModel& model) {
  const std::vector<Eigen::Index> first = frequency_groups(model.angular_frequency);
  const int groups = int(first.size()) - 1;
  Probes probes;
  std::vector<int> modes;
  for (int k = 0; k < std::min(probed_groups, groups) && int(modes.size()) < max_probed; ++k) {
    const auto g = std::size_t(groups - 1 - (k < probed_groups / 2 ? k : k * groups / probed_groups));
    probes.segments.push_back({Eigen::Index(3 * modes.size()), 3 * (first[g + 1] - first[g])});
    for (Eigen::Index m = first[g]; m < first[g + 1]; ++m) modes.push_back(int(m));
  }
  probes.of_point.assign(model.points.size(), Probe(3 * modes.size()));
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    for (std::size_t k = 0; k < modes.size(); ++k)
      probes.of_point[p].segment<3>(Eigen::Index(3 * k)) = model.shape(int(p), modes[k]).cast<float>();
  }
  for (const Segment& s : probes.segments) {
    float most = 0;
    for (const Probe& probe : probes.of_point) most = std::max(most, probe.segment(s.first, s.size).norm());
    for (Probe& probe : probes.of_point) probe.segment(s.first, s.size) /= most;
  }
  return probes;
}

// Position of a removed point.
struct FacePoint {
  int face = -1;
  Vec3 weights = Vec3::Zero();
};

class EdgeCollapse {
 public:
  EdgeCollapse(const ModalModel& model, const SampleOptions& options)
      : points_(model.points),
        probes_(make_probes(model)),
        faces_(model.triangles),
        faces_of_(points_.size()),
        removed_in_face_(faces_.size()),
        is_removed_(points_.size(), false),
        options_(options) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : points_) box.extend(p);
    reach_ = options.distance * box.diagonal().norm();
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      for (const int p : faces_[f]) faces_of_[std::size_t(p)].push_back(int(f));
    }
  }

  void run(const std::atomic<bool>* stop) {
    for (int collapsed = 1; collapsed > 0;) {
      collapsed = 0;
      for (const auto& [a, b] : edges_by_length()) {
        if (stop_requested(stop)) return;
        if (is_removed_[std::size_t(a)] || is_removed_[std::size_t(b)]) continue;
        collapsed += collapse(b, a) || collapse(a, b);
      }
    }
  }

  const std::vector<Triangle>& faces() const { return faces_; }
  bool is_removed(int point) const { return is_removed_[std::size_t(point)]; }

  // Calls visit(point, face, barycentric weights) for every removed point.
  template <class Visit>
  void for_each_removed(Visit visit) const {
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      for (const int p : removed_in_face_[f])
        visit(p, faces_[f], weights(points_[std::size_t(p)], faces_[f]));
    }
  }

 private:
  std::vector<std::pair<int, int>> edges_by_length() const {
    std::vector<std::pair<double, std::pair<int, int>>> edges;
    for (const Triangle& t : faces_) {
      if (t[0] < 0) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        if (a < b)
          edges.push_back({(points_[std::size_t(a)] - points_[std::size_t(b)]).squaredNorm(), {a, b}});
      }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<std::pair<int, int>> pairs;
    for (const auto& edge : edges) pairs.push_back(edge.second);
    return pairs;
  }

  Vec3 weights(const Vec3& p, const Triangle& t) const {
    return nearest_barycentric(p, points_[std::size_t(t[0])], points_[std::size_t(t[1])],
                               points_[std::size_t(t[2])]);
  }
  // Whether collapsing the edge leaves the surface manifold. An inner point has each neighbour in two faces
  // of its ring; the collapse is safe if its two ends share just the two neighbours beside the edge (the link
  // condition).
  bool is_manifold_at(int removed, int into) {
    ring_.clear();
    for (const int f : faces_of_[std::size_t(removed)]) {
      for (const int p : faces_[std::size_t(f)]) {
        if (p != removed) ring_.push_back(p);
      }
    }
    std::sort(ring_.begin(), ring_.end());
    for (std::size_t k = 0; k < ring_.size(); k += 2) {
      if (k + 1 == ring_.size() || ring_[k] != ring_[k + 1] ||
          (k + 2 < ring_.size() && ring_[k + 2] == ring_[k]))
        return false;
    }
    int common = 0;
    for (std::size_t k = 0; k < ring_.size(); k += 2) {
      const auto& faces = faces_of_[std::size_t(ring_[k])];
      common += std::any_of(faces.begin(), faces.end(), [&](int f) {
        const Triangle& t = faces_[std::size_t(f)];
        return std::find(t.begin(), t.end(), into) != t.end();
      });
    }
    return common == 3;  // `into` itself counts, too
  }

  bool is_acceptable(const Triangle& before, const Triangle& after) const {
    const Vec3 old_cross = triangle_cross(points_, before), new_cross = triangle_cross(points_, after);
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(
          longest, (points_[std::size_t(after[k])] - points_[std::size_t(after[(k + 1) % 3])]).squaredNorm());
    return new_cross.norm() > min_face_quality * longest &&
           new_cross.dot(old_cross) > min_normal_cosine * new_cross.norm() * old_cross.norm();
  }

  // Relocates the removed points of the faces around `removed` into the new faces; false if any exceeds the
  // error limit.
  bool relocate_removed(int removed) {
    places_.clear();
    const auto place = [&](int p) {
      const Vec3& at = points_[std::size_t(p)];
      FacePoint best;
      double nearest = reach_;
      for (const auto& [f, t] : changed_) {
        const Vec3 w = weights(at, t);
        const double distance = (w[0] * points_[std::size_t(t[0])] + w[1] * points_[std::size_t(t[1])] +
                                 w[2] * points_[std::size_t(t[2])] - at)
                                    .norm();
        if (distance < nearest) {
          nearest = distance;
          best = {f, w};
          corners_ = t;
        }
      }
      if (best.face < 0) return false;
      const auto probe = [&](int point) -> const Probe& { return probes_.of_point[std::size_t(point)]; };
      error_ = probe(p) - float(best.weights[0]) * probe(corners_[0]) -
               float(best.weights[1]) * probe(corners_[1]) - float(best.weights[2]) * probe(corners_[2]);
      for (const Segment& s : probes_.segments) {
        if (!(error_.segment(s.first, s.size).norm() < float(options_.shape_error))) return false;
      }
      places_.emplace_back(p, best.face);
      return true;
    };
    if (!place(removed)) return false;
    for (const int f : faces_of_[std::size_t(removed)]) {
      for (const int p : removed_in_face_[std::size_t(f)]) {
        if (!place(p)) return false;
      }
    }
    return true;
  }

  bool collapse(int removed, int into) {
    if (!is_manifold_at(removed, into)) return false;
    changed_.clear();
    for (const int f : faces_of_[std::size_t(removed)]) {
      Triangle t = faces_[std::size_t(f)];
      if (std::find(t.begin(), t.end(), into) != t.end()) continue;
      std::replace(t.begin(), t.end(), removed, into);
      if (!is_acceptable(faces_[std::size_t(f)], t)) return false;
      changed_.emplace_back(f, t);
    }
    if (!relocate_removed(removed)) return false;
    for (const int f : faces_of_[std::size_t(removed)]) {
      removed_in_face_[std::size_t(f)].clear();
      Triangle& t = faces_[std::size_t(f)];
      if (std::find(t.begin(), t.end(), into) == t.end()) continue;
      for (const int p : t) {
        if (p != removed) std::erase(faces_of_[std::size_t(p)], f);
      }
      t = {-1, -1, -1};
    }
    for (const auto& [f, t] : changed_) {
      faces_[std::size_t(f)] = t;
      faces_of_[std::size_t(into)].push_back(f);
    }
    for (const auto& [p, f] : places_) removed_in_face_[std::size_t(f)].push_back(p);
    faces_of_[std::size_t(removed)].clear();
    is_removed_[std::size_t(removed)] = true;
    return true;
  }

  std::vector<Vec3> points_;
  Probes probes_;
  std::vector<Triangle> faces_;  // -1: removed
  std::vector<std::vector<int>> faces_of_, removed_in_face_;
  std::vector<bool> is_removed_;
  SampleOptions options_;
  double reach_ = 0;
  // Scratch of the current collapse.
  std::vector<int> ring_;
  std::vector<std::pair<int, Triangle>> changed_;
  std::vector<std::pair<int, int>> places_;  // point, face
  Triangle corners_{};
  Probe error_;
};

// The worst group's error, relative to its size: root mean squares over the removed points and over all
// points.
double worst_error(const ModalModel& model, const EdgeCollapse& collapse) {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(model.modes()), size = error;
  int removed = 0;
  collapse.for_each_removed([&](int p, const Triangle& t, const Vec3& w) {
    ++removed;
    for (int m = 0; m < model.modes(); ++m) {
      const Vec3 between =
          w[0] * model.shape(t[0], m) + w[1] * model.shape(t[1], m) + w[2] * model.shape(t[2], m);
      error[m] += (between - model.shape(p, m)).squaredNorm();
    }
  });
  if (removed == 0) return 0;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    for (int m = 0; m < model.modes(); ++m) size[m] += model.shape(int(p), m).squaredNorm();
  }
  const std::vector<Eigen::Index> first = frequency_groups(model.angular_frequency);
  double worst = 0;
  for (std::size_t g = 0; g + 1 < first.size(); ++g) {
    const Eigen::Index modes = first[g + 1] - first[g];
    worst = std::max(worst, error.segment(first[g], modes).sum() / size.segment(first[g], modes).sum());
  }
  return std::sqrt(worst / double(removed) * double(model.points.size()));
}

}  // namespace

void sample_surface(ModalModel& model, const SampleOptions& options, const std::atomic<bool>* stop) {
  if (model.modes() == 0 || !(options.shape_error > 0)) return;
  EdgeCollapse collapse(model, options);
  collapse.run(stop);
  model.shape_error = worst_error(model, collapse);
  std::vector<int> number(model.points.size(), -1);
  std::vector<Vec3> points;
  std::vector<float> shapes;
  const std::size_t row = 3 * std::size_t(model.modes());
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    if (collapse.is_removed(int(p))) continue;
    number[p] = int(points.size());
    points.push_back(model.points[p]);
    shapes.insert(shapes.end(), model.shapes.begin() + std::ptrdiff_t(p * row),
                  model.shapes.begin() + std::ptrdiff_t((p + 1) * row));
  }
  model.triangles.clear();
  for (const auto& [a, b, c] : collapse.faces()) {
    if (a >= 0)
      model.triangles.push_back({number[std::size_t(a)], number[std::size_t(b)], number[std::size_t(c)]});
  }
  model.points = std::move(points);
  model.shapes = std::move(shapes);
}

}  // namespace intaglio::sound
