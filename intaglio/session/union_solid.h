// Several textured slabs as one thing to touch: the pen meets whichever it is deepest in.
//
// The depth is the greatest of the slabs' depths: continuous, so that an energy made of it is one too; its
// gradient is that of the deepest. A slab costs 0.1 us. Real-time; any thread.
#pragma once

#include <memory>
#include <vector>

#include "intaglio/haptics/solid.h"

namespace intaglio::session {

class UnionSolid : public haptics::Solid {
 public:
  void add(std::unique_ptr<haptics::Solid> part) { parts_.push_back(std::move(part)); }

  haptics::Penetration at(const Vec3& p) const override {
    haptics::Penetration deepest{-1e9, -Vec3::UnitY()};
    for (const auto& part : parts_)
      if (const haptics::Penetration here = part->at(p); here.depth > deepest.depth) deepest = here;
    return deepest;
  }

 private:
  std::vector<std::unique_ptr<haptics::Solid>> parts_;
};

}  // namespace intaglio::session
