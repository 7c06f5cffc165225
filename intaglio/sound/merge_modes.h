// Modes that no listener tells apart become one, so that a model costs less to play.
//
// Two modes are merged when they beat so slowly that they are gone before it is heard (|omega_i - omega_k| <=
// (d_i + d_k) / 2: at the first trough they are 27 dB down) and neither moves by more than 0.2 % in pitch,
// the least that is heard. The one has the sum of their radiated shapes, which of modes at one frequency is
// exactly what they sound like together (radiation.h). A mode is left out when 20 dB below its band wherever
// and however the body is struck. Both only as long as no auditory band changes by more than asked
// (band_energy.h). Shapes merged from different frequencies are mass-normalised no longer; scaled up
// (scaled_model.h), modes ring longer for their distance, and the error grows. Cost: some 0.4 s for 100
// modes. Sources: Raghuvanshi & Lin, "Interactive sound synthesis for large scale environments", 2006
// (merging what is not discriminated); Wier, Jesteadt & Green, "Frequency discrimination as a function of
// frequency and sensation level", 1977 (0.2 %).
#pragma once

#include "intaglio/sound/band_energy.h"

namespace intaglio::sound {

// Merges modes of `model` and states in it how many there were and what changed: at most `allowed_db` in any
// band, at any of its points, for a blow in any direction. 0 merges nothing.
void merge_modes(ModalModel& model, double allowed_db);

}  // namespace intaglio::sound
