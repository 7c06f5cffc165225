// Parquet in herringbone: pieces of 1 x `length` cells, lying and standing in turn.
//
// In cell (i, j) let k = (i - j) mod 2 length. Where k < length a lying piece began k cells to the left;
// elsewhere a standing one began 2 length - 1 - k cells below. It repeats when the cells a side are a
// multiple of 2 length.
#include "intaglio/surface/builtin/layout.h"

namespace intaglio::surface {

namespace {

class Herringbone : public Cells {
 public:
  explicit Herringbone(const LayoutRecipe& recipe) : r_(recipe) {}

  Spot at(double u, double v) const override {
    const int n = r_.columns;
    const int length = r_.length;
    const int i = static_cast<int>(std::floor(u * n));
    const int j = static_cast<int>(std::floor(v * n));
    const int k = wrapped(i - j, 2 * length);
    const Vec2 half(0.5 * length / n, 0.5 / n);
    const bool lying = k < length;
    const int start_i = lying ? i - k : i;
    const int start_j = lying ? j : j - (2 * length - 1 - k);
    const Vec2 from_start(u - double(start_i) / n, v - double(start_j) / n);
    const Vec2 local =
        lying ? Vec2(from_start - half) : Vec2(from_start.y() - half.x(), half.y() - from_start.x());
    return {wrapped(start_i, n), wrapped(start_j, n), inside_box(local, half, r_), local, half, 1};
  }

 private:
  LayoutRecipe r_;
};

}  // namespace

std::unique_ptr<Cells> make_herringbone(const LayoutRecipe& recipe, std::uint64_t) {
  return std::make_unique<Herringbone>(recipe);
}

}  // namespace intaglio::surface
