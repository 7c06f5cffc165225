// Rows of rectangles: bricks, tiles, planks, ashlar; without columns, endless strips.
#include "intaglio/surface/builtin/layout.h"
#include "intaglio/surface/noise.h"

namespace intaglio::surface {

namespace {

class Bond : public Cells {
 public:
  Bond(const LayoutRecipe& recipe, std::uint64_t seed) : r_(recipe), seed_(seed) {}

  Spot at(double u, double v) const override {
    const double y = v * r_.rows;
    const int j = cell(y, [&](int k) { return row_border(k); });
    const int row = wrapped(j, r_.rows);
    const double low_v = row_border(j) / r_.rows;
    const double high_v = row_border(j + 1) / r_.rows;
    if (r_.columns == 0) return strip(u, v, row, low_v, high_v);
    const double shift = ((j & 1) != 0 ? r_.shift : 0.0) +
                         (r_.stagger > 0 ? r_.stagger * lattice_hash(row, 0, seed_ + 12) : 0.0);
    const int i = cell(u * r_.columns + shift, [&](int k) { return column_border(k, row); });
    const Box box{(column_border(i, row) - shift) / r_.columns,
                  (column_border(i + 1, row) - shift) / r_.columns, low_v, high_v};
    return cut(u, v, wrapped(i, r_.columns), row, box);
  }

 private:
  struct Box {
    double low_u, high_u, low_v, high_v;
  };

  // The k with border(k) <= x < border(k + 1); borders stray less than half a cell.
  template <class Border>
  static int cell(double x, const Border& border) {
    const int k = static_cast<int>(std::floor(x));
    if (x < border(k)) return k - 1;
    return x < border(k + 1) ? k : k + 1;
  }

  double row_border(int k) const {
    return r_.uneven.y() > 0 ? k + r_.uneven.y() * (lattice_hash(0, wrapped(k, r_.rows), seed_ + 10) - 0.5)
                             : k;
  }
  double column_border(int k, int row) const {
    if (r_.uneven.x() <= 0) return k;
    return k + r_.uneven.x() * (lattice_hash(wrapped(k, r_.columns), row, seed_ + 11) - 0.5);
  }

  Spot strip(double u, double v, int row, double low_v, double high_v) const {
    const Vec2 half(endless, 0.5 * (high_v - low_v));
    const Vec2 local(u, v - 0.5 * (low_v + high_v));
    return {0, row, inside_box(local, half, r_), local, half, 1};
  }

  // The piece, or that part of it that holds the point when chance cuts it across its longer side.
  Spot cut(double u, double v, int column, int row, Box box) const {
    if (r_.split > 0 && lattice_hash(column, row, seed_ + 13) < r_.split) {
      const double share = 0.36 + 0.28 * lattice_hash(column, row, seed_ + 14);
      const bool along_u = box.high_u - box.low_u > box.high_v - box.low_v;
      double& low = along_u ? box.low_u : box.low_v;
      double& high = along_u ? box.high_u : box.high_v;
      const double middle = low + share * (high - low);
      const bool upper = (along_u ? u : v) >= middle;
      (upper ? low : high) = middle;
      if (upper) column += r_.columns;  // a name of its own
    }
    const Vec2 half(0.5 * (box.high_u - box.low_u), 0.5 * (box.high_v - box.low_v));
    const Vec2 local(u - 0.5 * (box.low_u + box.high_u), v - 0.5 * (box.low_v + box.high_v));
    return {column, row, inside_box(local, half, r_), local, half, 1};
  }

  LayoutRecipe r_;
  std::uint64_t seed_;
};

}  // namespace

std::unique_ptr<Cells> make_bond(const LayoutRecipe& recipe, std::uint64_t seed) {
  return std::make_unique<Bond>(recipe, seed);
}

}  // namespace intaglio::surface
