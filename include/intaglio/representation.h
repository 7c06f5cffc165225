// How much of a texture the senses use. One choice holds for contact, touch, sound and picture, so that they agree.
#pragma once

namespace intaglio {

enum class Representation {
  flat,    // nothing: the plain base geometry, for comparison
  normal,  // the normals alone, on a flat base: contacts with tilted normals (Sterling & Lin 2016, §1.2)
  relief,  // depth and normals: the true shape (§1.3)
};

}  // namespace intaglio
