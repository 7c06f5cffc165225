#include "surface/maps.h"

#include <algorithm>
#include <cmath>

#include "surface/import.h"
#include "surface/recipes/builtin.h"

namespace intaglio::surface {

namespace {

// Row y of an image (0 = top) as a row of texels (0 = bottom), and back.
int flipped(int y, int height) {
  return height - 1 - y;
}

Vec3 vector_at(const Pixels& image, int x, int y) {
  return {2.0 * double(image.at(x, y, 0)) - 1, 2.0 * double(image.at(x, y, 1)) - 1,
          2.0 * double(image.at(x, y, 2)) - 1};
}

}  // namespace

void map_signed_normals_to_unit_range(Pixels& image) {
  if (image.channels < 3 || std::none_of(image.data.begin(), image.data.end(), [](float v) { return v < 0; }))
    return;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = 0.5f * image.at(x, y, c) + 0.5f;
    }
  }
}

bool stretch_to_unit_range(Field& field) {
  const auto [low, high] = std::minmax_element(field.value.begin(), field.value.end());
  if (field.empty() || (*low >= 0 && *high <= 1)) return false;
  const double from = *low;
  const double range = std::max(1e-30, double(*high) - from);
  for (float& v : field.value) v = float((double(v) - from) / range);
  return true;
}

bool looks_like_normals(const Pixels& image) {
  std::size_t unit = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3 n = vector_at(image, x, y);
      if (std::abs(n.norm() - 1) < 0.15 && n.z() > 0) ++unit;
    }
  }
  return unit * 10 > std::size_t(image.width) * std::size_t(image.height) * 8;
}

bool is_constant(const Pixels& image, int channel) {
  const auto step = std::size_t(image.channels);
  const float first = image.data[std::size_t(channel)];
  for (std::size_t p = std::size_t(channel); p < image.data.size(); p += step) {
    if (image.data[p] != first) return false;
  }
  return true;
}

MapSlopes read_slopes(const Pixels& image) {
  MapSlopes out{{Field(image.width, image.height), Field(image.width, image.height)}, 0};
  std::size_t beyond = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3 n = vector_at(image, x, y);
      // A height field has no overhangs; 8-bit files round the z of vertical walls to below 0.
      const double up = std::max(n.z(), 1e-6);
      Vec2 slope(-n.x() / up, -n.y() / up);
      if (slope.norm() > max_slope) {
        ++beyond;
        slope *= max_slope / slope.norm();
      }
      out.slopes.x.at(x, flipped(y, image.height)) = float(slope.x());
      out.slopes.y.at(x, flipped(y, image.height)) = float(slope.y());
    }
  }
  out.clamped = double(beyond) / double(out.slopes.x.value.size());
  return out;
}

Field read_height(const Pixels& image, int channel) {
  Field height(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const bool brightness = image.channels == 3 || (image.channels == 4 && channel != 3);
      height.at(x, flipped(y, image.height)) =
          brightness ? image.at(x, y, 0) / 3 + image.at(x, y, 1) / 3 + image.at(x, y, 2) / 3
                     : image.at(x, y, channel);
    }
  }
  return height;
}

Image8 read_colour(const Pixels& image) {
  Image8 colour(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float value = image.at(x, y, image.channels < 3 ? 0 : c);
        colour.at(x, flipped(y, image.height), c) =
            std::uint8_t(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
      }
    }
  }
  return colour;
}

Image8 default_colour() {
  Image8 colour(1, 1, 3);
  std::fill(colour.data.begin(), colour.data.end(), std::uint8_t{176});
  return colour;
}

Field resample(const Field& field, int width, int height) {
  Field out(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double fx = std::clamp((x + 0.5) * field.width / width - 0.5, 0.0, field.width - 1.0);
      const double fy = std::clamp((y + 0.5) * field.height / height - 0.5, 0.0, field.height - 1.0);
      const int x0 = std::min(int(fx), std::max(0, field.width - 2));
      const int y0 = std::min(int(fy), std::max(0, field.height - 2));
      const int x1 = std::min(x0 + 1, field.width - 1);
      const int y1 = std::min(y0 + 1, field.height - 1);
      const auto s = float(fx - x0);
      const auto t = float(fy - y0);
      out.at(x, y) = (1 - t) * ((1 - s) * field.at(x0, y0) + s * field.at(x1, y0)) +
                     t * ((1 - s) * field.at(x0, y1) + s * field.at(x1, y1));
    }
  }
  return out;
}

void flip_rows(Field& field) {
  for (int y = 0; y < field.height / 2; ++y) {
    for (int x = 0; x < field.width; ++x) std::swap(field.at(x, y), field.at(x, flipped(y, field.height)));
  }
}

void negate(Field& field) {
  scale(field, -1);
}

void invert(Field& field) {
  for (float& v : field.value) v = 1 - v;
}

void scale(Field& field, double factor) {
  for (float& v : field.value) v *= float(factor);
}

void scale(Slopes& slopes, double factor) {
  scale(slopes.x, factor);
  scale(slopes.y, factor);
}

std::vector<Vec3> normals_of(const Slopes& slopes) {
  std::vector<Vec3> normals(slopes.x.value.size());
  for (std::size_t k = 0; k < normals.size(); ++k)
    normals[k] = Vec3(-double(slopes.x.value[k]), -double(slopes.y.value[k]), 1).normalized();
  return normals;
}

void rescale_normals(std::vector<Vec3>& normals, double factor) {
  for (Vec3& n : normals) n = Vec3(factor * n.x(), factor * n.y(), n.z()).normalized();
}

Slopes central_slopes(const Field& height, double depth_fraction) {
  const int w = height.width;
  const int h = height.height;
  const auto scale_to_slope = float(depth_fraction * w / 2);  // texels are square
  Slopes slopes{Field(w, h), Field(w, h)};
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      slopes.x.at(x, y) = scale_to_slope * (height.at((x + 1) % w, y) - height.at((x + w - 1) % w, y));
      slopes.y.at(x, y) = scale_to_slope * (height.at(x, (y + 1) % h) - height.at(x, (y + h - 1) % h));
    }
  }
  return slopes;
}

Texels to_texels(const TextureImages& images) {
  const Pixels relief = to_unit_range(images.relief);
  const Field depth = read_height(relief, 3);
  return {relief.width, relief.height, depth.value, normals_of(read_slopes(relief).slopes),
          read_colour(to_unit_range(images.colour))};
}

namespace {

// Half the size, without an odd last row or column: only correlations are taken from it.
Field halved(const Field& field) {
  Field half(std::max(1, field.width / 2), std::max(1, field.height / 2));
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      const int x1 = std::min(2 * x + 1, field.width - 1);
      const int y1 = std::min(2 * y + 1, field.height - 1);
      half.at(x, y) =
          0.25f * (field.at(2 * x, 2 * y) + field.at(x1, 2 * y) + field.at(2 * x, y1) + field.at(x1, y1));
    }
  }
  return half;
}

// Moments of pairs (a, b).
struct Moments {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(double x, double y) {
    n += 1;
    a += x;
    b += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  double correlation() const {
    const double var_a = aa - a * a / n;
    const double var_b = bb - b * b / n;
    return var_a > 1e-12 * aa && var_b > 1e-12 * bb && var_a > 0 && var_b > 0
               ? (ab - a * b / n) / std::sqrt(var_a * var_b)
               : 0;
  }
};

struct Agreement {
  double u = 0, v = 0;
  double covariance = 0;  // of both axes, sum of slope products
  double power = 0;       // of the height's slopes, sum of squares
  double score() const { return std::sqrt(0.5 * (u * u + v * v)); }
};

// Slopes of the height are those of a full depth of one side.
Agreement compare(const Slopes& slopes, const Field& height) {
  Moments u, v;
  const double scale = height.width / 2.0;
  // Inner texels only, because the tile may not wrap.
  for (int y = 1; y + 1 < height.height; ++y) {
    for (int x = 1; x + 1 < height.width; ++x) {
      u.add(slopes.x.at(x, y), scale * (height.at(x + 1, y) - height.at(x - 1, y)));
      v.add(slopes.y.at(x, y), scale * (height.at(x, y + 1) - height.at(x, y - 1)));
    }
  }
  Agreement out;
  if (u.n > 8) {
    out.u = u.correlation();
    out.v = v.correlation();
  }
  out.covariance = std::abs(u.ab) + std::abs(v.ab);
  out.power = u.bb + v.bb;
  return out;
}

}  // namespace

Detection detect_conventions(const Slopes& slopes, const Field& height) {
  Slopes s = slopes;
  Field h = height, flipped = height;
  flip_rows(flipped);
  Agreement best;
  bool rows_flipped = false;
  for (int level = 0; level < 4 && std::min(h.width, h.height) >= 16; ++level) {
    const Agreement as_given = compare(s, h);
    const Agreement upside_down = compare(s, flipped);
    // Flipping needs clear evidence: symmetric textures correlate both ways.
    if (as_given.score() > best.score() && !(rows_flipped && as_given.score() < best.score() + 0.2)) {
      best = as_given;
      rows_flipped = false;
    }
    if (upside_down.score() > as_given.score() + 0.2 &&
        upside_down.score() > best.score() + (rows_flipped ? 0 : 0.2)) {
      best = upside_down;
      rows_flipped = true;
    }
    s = {halved(s.x), halved(s.y)};
    h = halved(h);
    flipped = halved(flipped);
  }
  Detection out;
  out.correlation_u = best.u;
  out.correlation_v = best.v;
  out.correlation = best.score();
  out.rows_flipped = rows_flipped;
  out.implied_depth = best.power > 0 ? best.covariance / best.power : 0;
  // The sign along u gives the polarity; the sign along v relative to u gives green's. An axis without
  // variation carries no information: then green is assumed to be +Y.
  constexpr double significant = 0.1;  // correlation
  const bool u_significant = std::abs(best.u) > significant;
  const bool v_significant = std::abs(best.v) > significant;
  const double reference = u_significant ? best.u : best.v;
  out.polarity = reference >= 0 ? Polarity::height : Polarity::depth;
  out.green =
      u_significant && v_significant && (best.u >= 0) != (best.v >= 0) ? Green::minus_y : Green::plus_y;
  return out;
}

}  // namespace intaglio::surface
