#include "intaglio/sound/scaled_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "intaglio/sound/radiation.h"

namespace intaglio::sound {

ModalModel scaled(const ModalModel& model, double scale) {
  assert(scale > 0);
  ModalModel out;
  out.name = model.name;
  out.material = model.material;
  out.mass = model.mass * scale * scale * scale;
  out.area = model.area * scale * scale;
  out.residual = model.residual;
  out.modes_found = model.modes_found;
  out.merge_error_db = model.merge_error_db;
  out.merge_error_rms_db = model.merge_error_rms_db;
  out.triangles = model.triangles;
  for (const Vec3& point : model.points) out.points.push_back(scale * point);
  out.grid = TriangleGrid(out.points, out.triangles);

  const double shape_scale = 1 / (scale * std::sqrt(scale));
  std::vector<std::size_t> kept;
  for (std::size_t m = 0; m < model.angular_frequency.size(); ++m) {
    const double omega = model.angular_frequency[m] / scale;
    const double d = 0.5 * (model.material.rayleigh_alpha + model.material.rayleigh_beta * omega * omega);
    if (d >= omega) continue;
    kept.push_back(m);
    out.angular_frequency.push_back(omega);
    out.damping.push_back(d);
    // Wavelengths grow as the body does, so only how far and how fast its surface moves is another.
    out.radiation.push_back(model.radiation[m] * scale * shape_scale);
  }
  // A mode that was merged from several had the allowance of all of them.
  const std::vector<double> share = radiated_share(model);
  std::vector<double> before;
  for (const std::size_t m : kept) before.push_back(share[m]);
  limit_radiation(out, before);
  const std::size_t modes = model.angular_frequency.size();
  for (std::size_t row = 0; row < 3 * model.points.size(); ++row) {
    for (const std::size_t m : kept)
      out.shapes.push_back(static_cast<float>(shape_scale) * model.shapes[row * modes + m]);
  }
  return out;
}

}  // namespace intaglio::sound
