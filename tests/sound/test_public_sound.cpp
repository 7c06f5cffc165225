// intaglio::ModalModel, as users have it.
#include <doctest/doctest.h>

#include "intaglio/sound.h"
#include "sound/api.h"
#include "tests/sound/models.h"

using intaglio::handle_of;
using intaglio::sound::test::model_of;

TEST_CASE("a mode that a model has not is 0 in every way, also of a model without modes") {
  for (const auto& model : {handle_of(model_of({440}, {1})), handle_of(model_of({}, {}))}) {
    for (const int mode : {-1, model.modes(), 100}) {
      CHECK(model.frequency(mode) == 0);
      CHECK(model.decay_time(mode) == 0);
      CHECK(model.gain(mode, {0, 0, 0}, {0, 0, 1}) == 0);
    }
  }
  const auto one = handle_of(model_of({440}, {1}));
  CHECK(one.frequency(0) == doctest::Approx(440));
  CHECK(one.gain(0, {0, 0, 0}, {0, 0, 1}) == doctest::Approx(1));
}
