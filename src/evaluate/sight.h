// The slope that a picture shows at every pixel, from how bright it is under four lamps.
//
// Photometric stereo (Woodham 1980) on rendered pixels: the surface is drawn from straight above under lamps
// from the left, right, near and far, without shadows and sky; the difference of opposite pictures over
// their sum is the slope. It is drawn white: on a dark surface the reflection of the lamps, which is no part
// of that law, would be as bright as it. So a normal map shows its slopes, a mesh its vertices' normals, a
// flat floor nothing. A lamp stands 60 degrees high: each component of the slope saturates at 1.73. The
// pixels are 8 bits deep: slopes up to 1 are known to 0.02 (tests/evaluate/test_sight.cpp). Needs EGL; 1 to 4
// CPU seconds on llvmpipe.
#pragma once

#include <vector>

#include "evaluate/subject.h"
#include "intaglio/error.h"

namespace intaglio::evaluate {

class Sight {
 public:
  static constexpr double steepest = 1.7320508075688772;  // tan 60 degrees

  // `pixels` a side. `drawn`: in place of the subject's surface (PictureReference::drawn).
  static Result<Sight> look(const Subject& subject, const Candidate& candidate, int pixels,
                            const surface::Surface* drawn = nullptr);
  // A surface that lies flat about the origin, thinner than a twentieth of its side, in that way.
  static Result<Sight> look(const surface::Surface& surface, const Candidate& candidate, int pixels);

  // dz/dx and dz/dy (local) seen at the pixel where a point (local, m) is drawn; bilinear.
  Vec2 slope(const Vec3& point) const;
  double cost() const { return cost_; }  // process-CPU seconds for one picture

 private:
  int pixels_ = 0;
  double focal_ = 0, height_ = 0;  // pixels; m, of the eye
  std::vector<Vec2> slopes_;       // row 0 = top
  surface::Placement placement_{Vec3::Zero(), Quat::Identity(), 1, 1};
  double cost_ = 0;
};

}  // namespace intaglio::evaluate
