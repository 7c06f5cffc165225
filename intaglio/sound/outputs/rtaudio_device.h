// The sound cards of this machine, through RtAudio: PulseAudio or PipeWire, ALSA, JACK, in that order.
//
// Opening and listing take milliseconds and may print nothing: what the systems below say on standard error
// meanwhile is swallowed (process-wide, so do it before other threads report errors there). The device may
// choose another buffer size than asked for. render() runs in the system's audio thread, with real-time
// scheduling where the user may have it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "intaglio/sound/outputs/audio_device.h"

namespace intaglio::sound {

struct SoundCard {
  std::string system;  // "pulse", "alsa", "jack"
  std::string name;
  int channels = 0;
  bool is_default = false;
  std::vector<int> sample_rates;  // Hz
  int preferred_rate = 0;         // Hz, 0: unknown
};

// All that can play.
std::vector<SoundCard> sound_cards();

// Opens the first card whose "system: name" contains `name`, the default one when that is empty.
Result<std::unique_ptr<AudioDevice>> open_sound_card(const std::string& name, int sample_rate,
                                                     int buffer_frames);

}  // namespace intaglio::sound
