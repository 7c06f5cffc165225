// A straight edge, an arc's chord or an axis with what may be a partner of it in the relief. Internal to
// contact/.
#pragma once

#include "intaglio/contact/leaf_walk.h"

namespace intaglio::contact {

// A pair of points of rod and relief counts when they are `above` apart or nearer with the relief below, or
// `below` with the relief above. Elsewhere there is nothing to look for.
class Rod {
 public:
  Rod(const Vec3& a, const Vec3& b, double above, double below)
      : a_(a), along_(b - a), length2_(along_.squaredNorm()), reach_(std::max(above, below)) {
    const double across2 = along_.head<2>().squaredNorm();
    // The plane through the rod that is level across it; there is none for an upright one.
    if (across2 * 100 < length2_) return;
    const Vec2 slope = along_.z() / across2 * along_.head<2>();
    level_ = {0, Vec3(slope.x(), slope.y(), -1)};
    // The partner is this far aside at most.
    level_.value = above + slope.norm() * reach_;
    is_level_ = true;
  }

  double reach() const { return reach_; }
  Vec2 low() const { return a_.head<2>().cwiseMin((a_ + along_).head<2>()) - Vec2::Constant(reach_); }
  Vec2 high() const { return a_.head<2>().cwiseMax((a_ + along_).head<2>()) + Vec2::Constant(reach_); }

  bool may_meet(const Piece& piece) const {
    if (is_level_ && piece.least({drop(piece.middle), level_.gradient}) > 0) return false;
    const Vec3 away = piece.middle - a_;
    const double u = std::min(std::max(along_.dot(away) / length2_, 0.0), 1.0);
    const Vec3 apart = away - u * along_;
    const double d = apart.norm();
    return d == 0 || piece.least({d, apart / d}) <= reach_;
  }
  // Whether a point of the relief is too far below. Where all corners of a crease or a patch are, it is.
  bool is_below(const Vec3& q) const { return is_level_ && drop(q) > 0; }

 private:
  double drop(const Vec3& q) const { return level_.gradient.dot(q - a_) - level_.value; }

  Vec3 a_, along_;
  double length2_, reach_;
  bool is_level_ = false;
  Tangent level_{0, Vec3::Zero()};
};

// Which texels of a leaf, the ones beyond its cells too, are not too far below a rod: bit 5 r + c.
inline unsigned texels_up(const Leaf& leaf, const Rod& rod) {
  unsigned up = 0;
  for (int r = 0; r <= Leaf::side; ++r) {
    for (int c = 0; c <= Leaf::side; ++c) up |= unsigned(!rod.is_below(leaf.texel(c, r))) << (5 * r + c);
  }
  return up;
}

// Calls corner, crease_x, crease_y and patch for what of the leaf has a corner that is up.
template <class Search>
void search_leaf(const Search& search, const Leaf& leaf, unsigned up) {
  for (int r = leaf.begin_r; r < leaf.end_r; ++r) {
    for (int c = leaf.begin_c; c < leaf.end_c; ++c) {
      const unsigned here = up >> (5 * r + c);
      if ((here & 1) != 0) search.corner(leaf, c, r);
      if (c < leaf.last_c && (here & 3) != 0) search.crease_x(leaf, c, r);
      if (r < leaf.last_r && (here & 0x21) != 0) search.crease_y(leaf, c, r);
      if (c < leaf.last_c && r < leaf.last_r && (here & 0x63) != 0) search.patch(leaf, c, r);
    }
  }
}

}  // namespace intaglio::contact
