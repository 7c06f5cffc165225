// Chooses an audio device by name.
#pragma once

#include <memory>
#include <string>

#include "intaglio/sound/outputs/audio_device.h"

namespace intaglio::sound {

struct AudioRequest {
  // "default": the system's, or the null device, with a note, where there is none. "null": nobody hears it.
  // Else a part of a name that `intaglio sound devices` lists; such a one that is missing is an error.
  std::string device = "default";
  int sample_rate = 44'100;  // Hz
  int buffer_frames = 256;   // 5.8 ms
};

struct OpenedDevice {
  std::unique_ptr<AudioDevice> device;
  std::string note;  // why it is not what was hoped for; empty when all is well
};

Result<OpenedDevice> open_audio_device(const AudioRequest& request = {});

}  // namespace intaglio::sound
