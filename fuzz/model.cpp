// Any bytes as a modal model: a model that can be written and asked, or one clear error on one line.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "sound/model_file.h"

using namespace intaglio;
using namespace intaglio::sound;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto model = parse_model({data, size}, "fuzz");
  if (!model) {
    const std::string message = model.error().message();
    if (message.find('\n') != std::string::npos || message.find("fuzz") != 0) std::abort();
    return 0;
  }
  if (model->triangles.empty()) std::abort();
  std::vector<float> gains(std::size_t(model->modes()));
  model->gains(Vec3(0.1, -0.2, 0.3), Vec3::UnitY(), gains);
  if (!parse_model(model_bytes(*model), "fuzz")) std::abort();
  return 0;
}
