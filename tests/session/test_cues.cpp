#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <array>
#include <string>
#include <vector>

#include "scene/cues.h"
#include "tests/session/sessions.h"

using namespace intaglio;
using scene::Cue;
using scene::Cues;

namespace {

Cues faults_in(const std::string& text) {
  Cues cues;
  const auto added = scene::add_faults(cues, text);
  REQUIRE_MESSAGE(added, added.error().message());
  return cues;
}

std::string fault_error(const std::string& text) {
  Cues cues;
  cues.touch.delay = 0.25;
  const Cues before = cues;
  const auto added = scene::add_faults(cues, text);
  REQUIRE_FALSE(added);
  CHECK(cues == before);
  return added.error().message();
}

}  // namespace

TEST_CASE("cues: faults in every form") {
  CHECK(faults_in("sound-delay=60ms").pen_sound.delay == 0.06);
  CHECK(faults_in("sound-delay=0.06s").ball_sound.delay == 0.06);
  CHECK(faults_in("touch-shift=10mm").touch.shift == Vec2(0.01, 0));
  CHECK(faults_in("touch-shift=1cm").touch.shift == Vec2(0.01, 0));
  CHECK(faults_in("touch-shift = +0.01 m").touch.shift == Vec2(0.01, 0));
  CHECK(faults_in("picture-shift=3x-4mm").picture.shift == Vec2(0.003, -0.004));
  CHECK(faults_in("picture-shift=3mmx0.4cm").picture.shift == Vec2(0.003, 0.004));
  CHECK(faults_in("picture-shift=0x4mm").picture.shift == Vec2(0, 0.004));
  CHECK_FALSE(faults_in("touch=off").touch.on);
  CHECK(faults_in("touch=off, touch = on").are_true());
  CHECK(faults_in("picture=walls/a=b").picture.texture == "walls/a=b");
  CHECK(faults_in("pen-sound-delay=5ms") == faults_in("pen_sound-delay=5ms"));
  CHECK(faults_in("motion=off") == faults_in("ball_motion=off"));
  CHECK(faults_in("ball-delay=9ms") == faults_in("ball_motion-delay=9ms,ball_sound-delay=9ms"));
  const Cues all = faults_in("all-delay=60ms,sound-delay=0ms");
  for (const Cue cue : scene::all_cues) {
    CAPTURE(scene::name_of(cue));
    CHECK(all[cue].delay == (cue == Cue::pen_sound || cue == Cue::ball_sound ? 0 : 0.06));
  }
  // -0 is 0: a cue without a change is true.
  CHECK(faults_in("touch-delay=-0ms,touch-shift=-0mm").are_true());
}

TEST_CASE("cues: each wrong fault is named, with what would be right") {
  const std::array<std::array<const char*, 2>, 22> wrong = {{
      {"", "faults: an empty part; for example sound-delay=60ms,picture=off"},
      {"touch=off,,picture=off", "faults: an empty part; for example sound-delay=60ms,picture=off"},
      {"tuch=off", "tuch=off: there is no cue \"tuch\"; did you mean touch?"},
      {"pikture-delay=5ms", "pikture-delay=5ms: there is no cue \"pikture\"; did you mean picture?"},
      {"smell=off",
       "smell=off: there is no cue \"smell\"; one of picture, touch, pen_sound, ball_motion, ball_sound, "
       "sound, motion, ball, all"},
      {"touch-dely=5ms", "touch-dely=5ms: a cue has no \"dely\"; did you mean touch-delay?"},
      {"touch-colour=red", "touch-colour=red: a cue has no \"colour\"; touch-delay or touch-shift"},
      {"touch", "touch: has no value; touch=off, touch-delay=60ms, touch-shift=10mm or touch=TEXTURE"},
      {"touch=", "touch=: has no value; off, on or a texture"},
      {"touch=60ms",
       "touch=60ms: 60ms is not a texture; did you mean touch-delay=60ms? (a texture of that name: ./60ms)"},
      {"sound=10mm",
       "sound=10mm: 10mm is not a texture; did you mean sound-shift=10mm? (a texture of that name: ./10mm)"},
      {"touch-delay=", "touch-delay=: a number is missing; for example 60ms or 0.06s"},
      {"touch-delay=soon", "touch-delay=soon: soon is not a number; for example 60ms or 0.06s"},
      {"touch-delay=nan", "touch-delay=nan: nan is not a number; for example 60ms or 0.06s"},
      {"touch-delay=60", "touch-delay=60: has no unit; for example 60ms or 0.06s"},
      {"touch-delay=60mm", "touch-delay=60mm: there is no unit \"mm\" here; for example 60ms or 0.06s"},
      {"touch-delay=1x2ms",
       "touch-delay=1x2ms: has two numbers where one is wanted; for example 60ms or 0.06s"},
      {"sound-delay=-5ms",
       "sound-delay=-5ms: a delay is negative: no sense can be early; delay the others instead, for example "
       "all-delay=60ms,sound-delay=0ms"},
      {"touch-delay=1.5s", "touch-delay=1.5s: a delay of 1.5 s is too long; at most 1 s"},
      {"touch-shift=1x2x3mm",
       "touch-shift=1x2x3mm: has more than two numbers; for example 10mm or 1cm along u, 3x-4mm along u and "
       "v"},
      {"touch-shift=5", "touch-shift=5: has no unit; for example 10mm or 1cm along u, 3x-4mm along u and v"},
      {"touch-shift=0x-2m", "touch-shift=0x-2m: a shift of 2 m is too far; between -1 m and 1 m"},
  }};
  for (const auto& [text, message] : wrong) CHECK(fault_error(text) == message);
}

TEST_CASE("cues: faults survive their way through text") {
  rc::check([] {
    Cues cues;
    for (const Cue cue : scene::all_cues) {
      scene::CueSettings& one = cues[cue];
      one.on = *rc::gen::arbitrary<bool>();
      one.delay = *rc::gen::inRange(0, 1'000'000'001) / 1e9;
      one.shift = Vec2(*rc::gen::inRange(-1'000'000, 1'000'001) / 1e6, *rc::gen::inRange(-3, 4) / 3.0);
      if (*rc::gen::arbitrary<bool>()) one.texture = *rc::gen::element<std::string>("brick", "a/b c.png");
    }
    if (*rc::gen::arbitrary<bool>()) cues.pen_sound = cues.ball_sound;
    Cues read;
    const auto added = scene::add_faults(read, scene::fault_text(cues));
    RC_ASSERT(cues.are_true() || added.has_value());
    RC_ASSERT(cues.are_true() || read == cues);
  });
}

TEST_CASE("cues: no text crashes, and a refused one changes nothing") {
  const std::array words = {"sound", "touch", "all", "-", "delay", "shift", "=",  ",",
                            "60",    "ms",    "x",   " ", "off",   "1e999", "-0", "."};
  rc::check([&] {
    std::string text;
    for (const int piece : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 20)))
      text += piece < int(words.size()) ? std::string(words[std::size_t(piece)])
                                        : *rc::gen::container<std::string>(rc::gen::arbitrary<char>());
    Cues cues;
    const auto added = scene::add_faults(cues, text);
    if (!added) RC_ASSERT(cues.are_true());
    if (!added) RC_ASSERT(added.error().message().find('\n') == std::string::npos);
    for (const Cue cue : scene::all_cues) {
      RC_ASSERT(cues[cue].delay >= 0);
      RC_ASSERT(cues[cue].delay <= scene::max_cue_delay);
      RC_ASSERT(cues[cue].shift.cwiseAbs().maxCoeff() <= scene::max_cue_shift);
    }
  });
}

TEST_CASE("cues: changes in words") {
  CHECK(scene::cue_note({}).empty());
  CHECK(scene::fault_text({}).empty());
  CHECK(scene::cue_note(faults_in("sound-delay=60ms")) == "cues: sound late by 60 ms");
  CHECK(scene::cue_note(faults_in("pen_sound-delay=60ms,touch=off,picture=planks")) ==
        "cues: picture of planks, touch off, the pen's sound late by 60 ms");
  CHECK(scene::cue_note(faults_in("touch-shift=10mm,motion-shift=0x-4mm")) ==
        "cues: touch shifted by 10 mm along u, motion shifted by -4 mm along v");
  CHECK(scene::fault_text(faults_in("sound-delay=0.06s,touch-shift=1cm,picture=off")) ==
        "picture=off,touch-shift=10mm,sound-delay=60ms");
}

TEST_CASE("cues: keys of a scene file") {
  const Cues cues = tests::parsed(
                        "[cues]\ntouch = false\npicture = true\n[cues.pen_sound]\ndelay = 0.06\nshift = "
                        "[0.01, -0.02]\n[cues.ball_motion]\non = false\ntexture = \"planks\"\n")
                        .cues;
  CHECK(cues ==
        faults_in("touch=off,pen_sound-delay=60ms,pen_sound-shift=10x-20mm,motion=off,motion=planks"));
  CHECK(tests::parsed("").cues.are_true());
  const std::array<std::array<const char*, 2>, 6> wrong = {{
      {"[cues]\ntuch = false\n", "s.toml:2: unknown key \"cues.tuch\"; did you mean \"touch\"?"},
      {"[cues]\ntouch = 1\n", "s.toml:2: cues.touch is a number; true or false is required"},
      {"[cues.touch]\ndelay = -0.1\n",
       "s.toml:2: cues.touch.delay is -0.1; a delay must be between 0 s and 1 s; no sense can be early, but the "
       "others can be late"},
      {"[cues.touch]\nshift = [2, 0]\n",
       "s.toml:2: cues.touch.shift is 2; a shift along u or v must be between -1 m and 1 m"},
      {"[cues.touch]\nof = false\n", "s.toml:2: unknown key \"cues.touch.of\"; did you mean \"on\"?"},
      {"cues = 3\n", "s.toml:1: cues is a number; a table is required: [cues]"},
  }};
  for (const auto& [text, message] : wrong) {
    const auto scene = scene::parse_scene(text, "s.toml");
    REQUIRE_FALSE(scene);
    CHECK(scene.error().message() == message);
  }
}
