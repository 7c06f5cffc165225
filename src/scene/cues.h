// Settings of each sense of a scene: switches, delays, and textures that differ from the true one.
//
// A run in which every sense has the same texture at the same time is true. A study, or a test of a metric,
// needs runs that lie in one known way: the sound 60 ms late, the touch of another texture. docs/cues.md says
// what each setting means physically. Values only, any thread. SI units.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/vec.h"

namespace intaglio::scene {

enum class Cue {
  picture,      // the floor as it is drawn, and when
  touch,        // the force that the hand gets
  pen_sound,    // the sound of the pen's contacts
  ball_motion,  // how bodies move
  ball_sound,   // the sound of the bodies' contacts
};

inline constexpr std::array all_cues = {Cue::picture, Cue::touch, Cue::pen_sound, Cue::ball_motion,
                                        Cue::ball_sound};

// As in scene files and on the command line: "pen_sound".
const char* name_of(Cue cue);

struct CueSettings {
  bool on = true;
  double delay = 0;                    // s, 0 to max_cue_delay
  Vec2 shift = Vec2::Zero();           // m, along u and v of the floor, each within +-max_cue_shift
  std::optional<std::string> texture;  // instead of the floor's own, named as there
  std::string line;  // where the texture was named, for errors: "file:line", or the part of a fault list

  bool is_true() const { return on && delay == 0 && !moves_texture(); }
  // Whether the cue needs a floor of its own: another texture, or the same one elsewhere.
  bool moves_texture() const { return shift != Vec2::Zero() || texture.has_value(); }
  // The line does not count.
  bool operator==(const CueSettings& other) const {
    return on == other.on && delay == other.delay && shift == other.shift && texture == other.texture;
  }
};

inline constexpr double max_cue_delay = 1, max_cue_shift = 1;  // s, m

struct Cues {
  CueSettings picture, touch, pen_sound, ball_motion, ball_sound;

  CueSettings& operator[](Cue cue);
  const CueSettings& operator[](Cue cue) const { return const_cast<Cues&>(*this)[cue]; }
  bool are_true() const;
  bool operator==(const Cues&) const = default;
};

// Whether both are given the same surfaces: they differ in delays and switches at most.
bool share_surfaces(const Cues& a, const Cues& b);

// Changes cues as a comma-separated list says, left to right:
//
//   sound-delay=60ms, touch-shift=10mm, picture=other_texture, ball_motion=off
//
// NAME-delay=60ms or 0.06s; NAME-shift=10mm, 1cm or 0.01m along u, or 3x-4mm along u and v; NAME=off;
// NAME=on, which switches on and leaves delay, shift and texture; NAME=TEXTURE, which has no comma (for a
// folder named "off": NAME=./off). NAME is a cue, or a group of cues: sound (both sounds), motion
// (ball_motion), ball (its motion and sound), all. An error names the part at fault, and `cues` are then as
// before.
Result<void> add_faults(Cues& cues, std::string_view text);

// The shortest such list that makes true cues into these; empty for true ones.
std::string fault_text(const Cues& cues);

// In words, one phrase a change: {"sound late by 60 ms", "touch shifted by 10 mm along u"}. Sounds that are
// changed alike are one.
std::vector<std::string> cue_changes(const Cues& cues);

// These as one line for logs and reports: "cues: sound late by 60 ms, touch off". Empty when all are true.
std::string cue_note(const Cues& cues);

}  // namespace intaglio::scene
