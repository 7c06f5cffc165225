// How much of a texture the senses use, and by which method. One choice of representation holds for contact,
// touch, sound and picture, so that they agree.
#pragma once

namespace intaglio {

enum class Representation {
  flat,    // nothing: the plain base geometry, for comparison
  normal,  // the normals alone (Sterling & Lin 2016, §1.2)
  relief,  // depth and normals: the true shape (§1.3)
};

// How contacts with a relief are found.
enum class ContactMethod {
  closest,      // ours: closest features, true penetration
  directional,  // the paper's: height maps compared along n_g, §1.3.1
};

// How bodies move on a normal map.
enum class NormalMethod {
  implied,  // ours: on the relief that the normals imply
  literal,  // the paper's: the flat contact with its normal replaced, Eq. 1.1 and 1.2, spheres only
};

}  // namespace intaglio
