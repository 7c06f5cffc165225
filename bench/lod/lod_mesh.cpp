#include "bench/lod/lod_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

namespace intaglio::bench {

namespace {

constexpr double contact_radius = 0.1;  // m
constexpr double blur_texels = 4, shading_gain = 4, height_gain = 2;

// The greatest height of a ball's lower side, or the least of its upper side, over each texel of a map:
// dilation or erosion by the ball, as the map repeats.
std::vector<double> swept(const std::vector<double>& z, int side, double step, double sign) {
  const int reach = int(contact_radius / step);
  struct Tap {
    int x, y;
    double height;
  };
  std::vector<Tap> ball;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const double square = contact_radius * contact_radius - (x * x + y * y) * step * step;
      if (square >= 0) ball.push_back({x, y, std::sqrt(square)});
    }
  }
  std::vector<double> out;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      double best = -1e9;
      for (const Tap& tap : ball) {
        const int column = (i + tap.x + side) % side, row = (j + tap.y + side) % side;
        best =
            std::max(best, sign * z[std::size_t(row) * std::size_t(side) + std::size_t(column)] + tap.height);
      }
      out.push_back(sign * best);
    }
  }
  return out;
}

std::vector<unsigned> grid_indices(int side, int step) {
  std::vector<unsigned> out;
  // The last row and column are kept whatever the step.
  const auto at = [&](int k) { return unsigned(std::min(k * step, side - 1)); };
  const int squares = (side - 2) / step + 1;
  for (int j = 0; j < squares; ++j) {
    for (int i = 0; i < squares; ++i) {
      const unsigned width = unsigned(side);
      const unsigned a = at(j) * width + at(i), b = at(j) * width + at(i + 1);
      const unsigned c = at(j + 1) * width + at(i + 1), d = at(j + 1) * width + at(i);
      out.insert(out.end(), {a, b, c, a, c, d});
    }
  }
  return out;
}

}  // namespace

std::string name_of(LodMetric metric) {
  switch (metric) {
    case LodMetric::geometry:
      return "mesh by geometry";
    case LodMetric::shading:
      return "mesh by shading";
    case LodMetric::heights:
      return "mesh by heights";
    case LodMetric::contact:
      return "mesh by contact";
    case LodMetric::grid:
      return "mesh, regular grid";
  }
  return "mesh";
}

LodChain::LodChain(const surface::Surface& full) : side_(full.width()), indices_(grid_indices(side_, 1)) {
  std::vector<double> z;
  for (int j = 0; j < side_; ++j)
    for (int i = 0; i < side_; ++i) z.push_back(full.texel_z(i, j));
  const std::vector<double> closing = swept(swept(z, side_, full.texel_u(), 1), side_, full.texel_u(), -1);
  for (int j = 0; j < side_; ++j) {
    for (int i = 0; i < side_; ++i) {
      const std::size_t k = all_.positions.size();
      const Vec2 uv((i + 0.5) / side_, (j + 0.5) / side_);
      const double x = (i + 0.5) * full.texel_u(), y = (j + 0.5) * full.texel_v();
      all_.positions.emplace_back(x, y, z[k]);
      all_.normals.push_back(full.normal(uv));
      all_.uvs.push_back(uv);
      const double mean = -full.sample(uv, blur_texels * full.texel_u()).depth;
      const std::array<double, 4> heights = {z[k], shading_gain * (z[k] - mean), height_gain * z[k],
                                             closing[k]};
      for (std::size_t metric = 0; metric < heights.size(); ++metric)
        metric_positions_[metric].insert(metric_positions_[metric].end(),
                                         {float(x), float(y), float(heights[metric])});
    }
  }
}

std::vector<unsigned> LodChain::grid(double share) const {
  const int step = std::max(1, int(std::lround(1 / std::sqrt(share))));
  return grid_indices(side_, step);
}

LodMesh LodChain::mesh(LodMetric metric, double share) const {
  if (metric == LodMetric::grid) return part(grid(share), metric);
  if (share >= 1) return part(indices_, metric);
  std::vector<unsigned> out(indices_.size());
  const std::size_t wanted = 3 * std::size_t(share * double(indices_.size() / 3));
  constexpr float any_error = 1e3F;
  const std::vector<float>& positions = metric_positions_[std::size_t(metric)];
  out.resize(meshopt_simplify(out.data(), indices_.data(), indices_.size(), positions.data(),
                              all_.positions.size(), 3 * sizeof(float), wanted, any_error, 0, nullptr));
  return part(out, metric);
}

LodMesh LodChain::part(const std::vector<unsigned>& indices, LodMetric metric) const {
  std::vector<int> number(all_.positions.size(), -1);
  LodMesh out;
  for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
    std::array<int, 3> triangle{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t vertex = indices[k + corner];
      if (number[vertex] < 0) {
        number[vertex] = int(out.positions.size());
        out.positions.push_back(all_.positions[vertex]);
        if (metric == LodMetric::contact)
          out.positions.back().z() = double(metric_positions_[std::size_t(metric)][3 * vertex + 2]);
        out.normals.push_back(all_.normals[vertex]);
        out.uvs.push_back(all_.uvs[vertex]);
      }
      triangle[corner] = number[vertex];
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

std::shared_ptr<const surface::Surface> reduced(const surface::Surface& full, int size) {
  const int block = full.width() / size;
  surface::Texels texels;
  texels.width = texels.height = size;
  texels.colour = Image8(1, 1, 3);
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      double depth = 0;
      Vec3 normal = Vec3::Zero();
      for (int y = 0; y < block; ++y) {
        for (int x = 0; x < block; ++x) {
          const int column = block * i + x, row = block * j + y;
          depth -= full.texel_z(column, row) / full.max_depth();
          normal += full.texel_normal({(column + 0.5) / full.width(), (row + 0.5) / full.height()});
        }
      }
      texels.depth.push_back(float(depth / (block * block)));
      texels.normal.push_back(normal.normalized());
    }
  }
  return std::make_shared<const surface::Surface>(std::move(texels), full.placement(), full.max_depth(),
                                                  full.edge());
}

}  // namespace intaglio::bench
