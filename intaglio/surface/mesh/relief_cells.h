// How high the relief is over a range of cells, and where to cut the range in two: the pyramid as a walk over
// a triangle sees it. The texture goes on beyond 0..1 as the edge mode says. No allocation; any thread.
#pragma once

#include <cstdint>

#include "intaglio/surface/mesh/relief_piece.h"
#include "intaglio/surface/surface.h"

namespace intaglio::surface {

// Cells from (i0, j0) to (i1, j1), both included, before wrapping.
struct CellRange {
  std::int64_t i0, i1, j0, j1;

  bool is_one() const { return i0 == i1 && j0 == j1; }
};

class ReliefCells {
 public:
  explicit ReliefCells(const Surface& surface);

  // The cells that a part of a triangle lies over; one for all where the relief is flat.
  CellRange range(const ReliefTriangle& triangle, const WeightPolygon& outline) const;
  // Bounds over a range, about a place in it (in cells).
  Heights heights(const CellRange& range, const Vec2& about) const;
  // Where to cut: axis 0 or 1, and the first cell of the second part. Blocks of the pyramid are cut at their
  // middle.
  struct Cut {
    int axis;
    std::int64_t cell;
  };
  Cut cut(const CellRange& range) const;
  // Sets heights and place of a piece that lies in a range of one cell.
  void load(const CellRange& one, ReliefPiece& piece) const;

  const Surface& surface() const { return surface_; }
  Vec2 texels() const { return {surface_.width(), surface_.height()}; }

 private:
  std::int64_t cut_between(std::int64_t first, std::int64_t last, std::int64_t cells) const;

  const Surface& surface_;
};

}  // namespace intaglio::surface
