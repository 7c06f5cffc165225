// The same body larger or smaller, without baking it again.
//
// When all lengths grow by s, frequencies go as 1 / s, mass as s^3, mass-normalised shapes as s^(-3/2),
// surface as s^2; damping follows from the material at the new frequency (Rayleigh), and radiation from size
// and frequency. The mesh turns with it exactly: this is what baking the scaled mesh gives, but for
// near-equal modes of damped materials: which of them sound as one (radiation.h) is kept as it was. Modes
// that no longer ring (overdamped) are left out. Milliseconds: it copies the model and makes its grid anew.
// Any thread.
#pragma once

#include "intaglio/sound/modal_model.h"

namespace intaglio::sound {

// `scale` > 0.
ModalModel scaled(const ModalModel& model, double scale);

}  // namespace intaglio::sound
