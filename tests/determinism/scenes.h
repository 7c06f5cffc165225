// The surfaces, bodies and modal models of the senses. Everything comes from recipes and seeds.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/shape.h"
#include "core/hash.h"
#include "core/portable_math.h"
#include "intaglio/event.h"
#include "mesh/relief_mesh.h"
#include "sound/synthesizer.h"
#include "surface/surface.h"

namespace intaglio::determinism {

inline void add(Hash& hash, double x) {
  hash.add(x);
}
inline void add(Hash& hash, const Vec2& v) {
  for (int k = 0; k < 2; ++k) hash.add(v[k]);
}
inline void add(Hash& hash, const Vec3& v) {
  for (int k = 0; k < 3; ++k) hash.add(v[k]);
}
inline void add(Hash& hash, const Pose& pose) {
  add(hash, pose.position);
  for (int k = 0; k < 4; ++k) hash.add(pose.orientation.coeffs()[k]);
}
void add(Hash& hash, const ContactEvent& event);

inline Vec3 any_vector(Random& random, double size) {
  const double x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}
inline Quat any_turn(Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return Quat(random.normal(), x, y, z).normalized();
}

// A built-in material, one metre a side at the origin.
std::shared_ptr<const surface::Surface> floor(const std::string& material, int texels = 128);
// The same as a ball's skin, its poles along Y.
surface::ReliefMesh skin(const std::string& material, double radius, bool is_bowl);
// Its texels through image files: detected, fused by Fourier transforms, of an odd number of texels a side.
surface::Texels imported(const std::string& material);

struct NamedShape {
  std::string name;
  contact::Shape shape;
};
// One of each kind, some 5 cm of radius.
std::vector<NamedShape> shapes();

// Floor 0 and bodies 1 to `count`, each of 100 modes made by hand.
std::vector<sound::SoundBody> sounding(std::shared_ptr<const surface::Surface> floor, int count);

}  // namespace intaglio::determinism
