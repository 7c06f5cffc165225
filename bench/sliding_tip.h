// A tip that slides over a texture, for measuring touch: its path, and a device that is led along it.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "haptics/device.h"
#include "haptics/proxy.h"
#include "intaglio/representation.h"
#include "surface/surface.h"

namespace intaglio::bench {

// 1 to 6 mm below the felt texture, at up to 0.4 m/s on a curve that visits all of a surface of
// 1 m, so that texels come from memory; one place a tick, as encoders of 23 um report it.
inline std::vector<Vec3> sliding_path(const std::shared_ptr<const surface::Surface>& s, int ticks,
                                      Representation representation = Representation::relief,
                                      double rate = 1000) {
  haptics::SolidOptions options;
  options.representation = representation;
  const haptics::TexturedSlab slab(s, options);
  std::vector<Vec3> path;
  for (int k = 0; k < ticks; ++k) {
    const double t = k / rate;
    Vec3 local(0.5 * s->placement().size_u() + 0.45 * std::sin(0.61 * t),
               0.5 * s->placement().size_v() - 0.45 * std::sin(0.37 * t + 1), 0);
    local.z() = slab.relief().at(s->placement().uv(local)).height - 0.0035 + 0.0025 * std::sin(9 * t);
    path.push_back((s->placement().to_world(local) / 2.3e-5).array().round().matrix() * 2.3e-5);
  }
  return path;
}

// Reports one place of a path after the other.
class LedDevice : public haptics::Device {
 public:
  explicit LedDevice(const std::vector<Vec3>& path) : path_(path) {}
  Vec3 read() override { return path_[next_++ % path_.size()]; }
  void write(const haptics::GuardedForce& force) override { last_ = force.newtons().y(); }
  double last() const { return last_; }  // N, upwards

 private:
  const std::vector<Vec3>& path_;
  std::size_t next_ = 0;
  double last_ = 0;
};

}  // namespace intaglio::bench
