// Any bytes as a modal model: a model that can be written and asked, or one clear error on one line.
#include "fuzz/require.h"
#include "sound/model_file.h"

using namespace intaglio;
using namespace intaglio::sound;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto model = parse_model({data, size}, "fuzz");
  if (!model) {
    fuzz::require_clear(model.error(), "fuzz");
    return 0;
  }
  fuzz::require(!model->triangles.empty());
  std::vector<float> gains(std::size_t(model->modes()));
  model->gains(Vec3(0.1, -0.2, 0.3), Vec3::UnitY(), gains);
  fuzz::require(parse_model(model_bytes(*model), "fuzz").has_value());
  return 0;
}
