// What is behind the classes of include/intaglio/sound.h, for the libraries that are handed one.
#pragma once

#include <memory>

#include "intaglio/sound.h"
#include "sound/live_sound.h"
#include "sound/modal_model.h"

namespace intaglio {

struct ModalModel::Impl {
  std::shared_ptr<const sound::ModalModel> model;
};

struct LiveSound::Impl {
  sound::LiveSound sound;
};

inline ModalModel handle_of(sound::ModalModel model) {
  return ModalModel(std::make_shared<const ModalModel::Impl>(
      ModalModel::Impl{std::make_shared<const sound::ModalModel>(std::move(model))}));
}

}  // namespace intaglio
