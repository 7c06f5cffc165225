// A cue changes its own stream as claimed and no other.
//
// The hand is as good as immovable and its device's steps are coarse, so that a changed force does not move
// the pen: what touch changes beyond the force comes from the hand, which a real one decides.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/hash.h"
#include "scene/picture.h"
#include "session/heard_contacts.h"
#include "session/late_values.h"
#include "session/simulation.h"
#include "tests/session/sessions.h"

using namespace intaglio;
using scene::Cue;

namespace {

const std::string pen_table =
    "[pen]\nstiffness = 50\nhand_mass = 100\nhand_stiffness = 1e5\nhand_damping = 1e4\n"
    "device_resolution = 5e-4\nramp_in = 0.5\n"
    "path = [[0, -0.2, 0.002, 0], [0.1, -0.2, -0.005, 0], [0.8, -0.12, -0.005, 0.02]]\n";
const std::string ball_table =
    "[[ball]]\nradius = 0.03\nmaterial = \"steel\"\nposition = [0.1, 0.06, 0.1]\nvelocity = [0.4, 0, -0.1]\n";
const std::string head =
    "duration = 0.8\n[sound]\nmeso = \"height\"\nmodes = 20\n[surface]\nmaterial = \"stone\"\n";
const std::string both = head + pen_table + ball_table;

struct Played {
  scene::Scene scene;
  scene::SceneSurface surface;
  session::Recording recording;
  std::vector<session::Snapshot> frames;
};

Played played(const std::string& text, const std::string& faults = "") {
  Played run{tests::parsed(text), {}, {}, {}};
  if (!faults.empty()) {
    const auto added = scene::add_faults(run.scene.cues, faults);
    REQUIRE_MESSAGE(added, added.error().message());
  }
  auto surface = scene::make_surface(run.scene);
  REQUIRE_MESSAGE(surface, surface.error().message());
  run.surface = std::move(*surface);
  auto simulation = session::Simulation::create(run.scene, run.surface, tests::cached_models());
  REQUIRE(simulation);
  (*simulation)->add_observer(run.recording);
  for (int k = 0; k < 24; ++k) run.frames.push_back((*simulation)->advance_to_frame(k));
  (*simulation)->finish();
  static_cast<session::Run&>(run.recording) = std::move((*simulation)->run());
  return run;
}

// Hashes of a run, stream by stream.
struct Streams {
  std::uint64_t drawn_bodies, drawn_pen, force, pen_contacts, ball_contacts, positions, sound;
};

void add(Hash& hash, const Vec3& v) {
  for (int k = 0; k < 3; ++k) hash.add(v[k]);
}

Streams streams_of(const Played& run) {
  Hash bodies, pen, force, pen_contacts, ball_contacts, positions;
  for (const session::Snapshot& frame : run.frames) {
    for (const Pose& pose : frame.balls) {
      add(bodies, pose.position);
      for (int k = 0; k < 4; ++k) bodies.add(pose.orientation.coeffs()[k]);
    }
    add(pen, frame.pen_tip.value_or(Vec3::Zero()));
  }
  for (const haptics::ServoSample& sample : run.recording.servo) add(force, sample.force);
  for (const ContactEvent& event : run.recording.events)
    (event.body == run.recording.pen ? pen_contacts : ball_contacts).add(session::event_row(event));
  for (const auto& track : run.recording.tracks)
    for (const Vec3& place : track) add(positions, place);
  return {bodies.value(),        pen.value(),       force.value(),           pen_contacts.value(),
          ball_contacts.value(), positions.value(), run.recording.audio_hash};
}

const Played& truth() {
  static const Played run = played(both);
  return run;
}

// The streams that a run changed, by their first letters: Bodies drawn, drawn pEn, Force, Pen's contacts,
// balls' Contacts, pOsitions, Sound.
std::string changed_streams(const Played& run) {
  const Streams a = streams_of(truth()), b = streams_of(run);
  std::string changed;
  const auto compare = [&](char name, std::uint64_t x, std::uint64_t y) {
    if (x != y) changed += name;
  };
  compare('B', a.drawn_bodies, b.drawn_bodies);
  compare('E', a.drawn_pen, b.drawn_pen);
  compare('F', a.force, b.force);
  compare('P', a.pen_contacts, b.pen_contacts);
  compare('C', a.ball_contacts, b.ball_contacts);
  compare('O', a.positions, b.positions);
  compare('S', a.sound, b.sound);
  return changed;
}

std::vector<Vec3> wanted_forces(const Played& run) {
  std::vector<Vec3> forces;
  for (const haptics::ServoSample& sample : run.recording.servo) forces.push_back(sample.wanted);
  return forces;
}

double peak(const std::vector<float>& audio) {
  double most = 0;
  for (const float sample : audio) most = std::max(most, double(std::abs(sample)));
  return most;
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, double(std::abs(a[k] - b[k])));
  return most;
}

std::vector<float> difference(const std::vector<float>& a, const std::vector<float>& b) {
  std::vector<float> out(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) out[k] = a[k] - b[k];
  return out;
}

// The lag at which b resembles a most, among `low` to `high` samples.
int lag_of(const std::vector<float>& a, const std::vector<float>& b, int low, int high) {
  double best = -1;
  int found = 0;
  for (int lag = low; lag <= high; ++lag) {
    double sum = 0;
    for (std::size_t k = 0; k + std::size_t(lag) < b.size(); ++k)
      sum += double(a[k]) * double(b[k + std::size_t(lag)]);
    if (sum > best) {
      best = sum;
      found = lag;
    }
  }
  return found;
}

}  // namespace

TEST_CASE("cues: the true scene moves, touches and sounds") {
  const session::Recording& run = truth().recording;
  CHECK(std::any_of(run.servo.begin(), run.servo.end(), [](const auto& s) { return s.force.norm() > 0.01; }));
  CHECK(std::any_of(run.events.begin(), run.events.end(), [&](const auto& e) { return e.body == run.pen; }));
  CHECK(std::any_of(run.events.begin(), run.events.end(), [&](const auto& e) { return e.body != run.pen; }));
  CHECK(peak(run.audio) > 1e-4);
  // Neutral settings are no settings, whatever way they came.
  CHECK(changed_streams(played(both, "all=on,all-delay=0s,all-shift=0mm")) == "");
  CHECK(changed_streams(played(both + "[cues]\ntouch = true\n[cues.picture]\ndelay = 0\n")) == "");
}

TEST_CASE("cues: each changes its own streams and no other") {
  const std::vector<std::pair<const char*, const char*>> effects = {{"picture=off", ""},
                                                                    {"picture-shift=10mm", ""},
                                                                    {"picture=wood_planks", ""},
                                                                    {"picture-delay=100ms", "BE"},
                                                                    {"touch=off", "F"},
                                                                    {"touch-delay=60ms", "F"},
                                                                    {"touch-shift=10mm", "F"},
                                                                    {"touch=pebbles", "F"},
                                                                    {"pen_sound=off", "S"},
                                                                    {"pen_sound-delay=60ms", "S"},
                                                                    {"pen_sound-shift=10mm", "S"},
                                                                    {"pen_sound=pebbles", "S"},
                                                                    {"ball_sound=off", "S"},
                                                                    {"ball_sound-delay=60ms", "S"},
                                                                    {"ball_sound-shift=10mm", "S"},
                                                                    {"ball_sound=pebbles", "S"},
                                                                    {"ball_motion-delay=100ms", "BO"},
                                                                    {"ball_motion=off", "BCOS"},
                                                                    {"ball_motion-shift=10mm", "BCOS"},
                                                                    {"ball_motion=pebbles", "BCOS"}};
  for (const auto& effect : effects) {
    CAPTURE(effect.first);
    CHECK(changed_streams(played(both, effect.first)) == effect.second);
  }
}

TEST_CASE("cues: the picture's floor is another, and late frames are earlier ones") {
  const Played shifted = played(both, "picture-shift=10mmx-20mm"),
               other = played(both, "picture=wood_planks"), off = played(both, "picture=off"),
               late = played(both, "picture-delay=100ms");
  const auto floor_of = [](const Played& run) {
    return scene::surface_parts(run.scene, run.surface).front().surface;
  };
  const surface::Surface& seen = *truth().surface.surface;
  CHECK(floor_of(truth()) == &seen);
  CHECK(floor_of(late) == late.surface.surface.get());
  // Along u is +X, along v is -Z.
  const Vec3 moved =
      floor_of(shifted)->placement().to_world(Vec3::Zero()) - seen.placement().to_world(Vec3::Zero());
  CHECK((moved - Vec3(0.01, 0, 0.02)).norm() < 1e-15);
  CHECK(floor_of(shifted)->identity() == shifted.surface.surface->identity());
  CHECK(floor_of(other)->depth({0.3, 0.4}) ==
        played(both, "all=wood_planks").surface.instead[0]->surface->depth({0.3, 0.4}));
  CHECK(floor_of(other)->depth({0.3, 0.4}) != seen.depth({0.3, 0.4}));
  const surface::Surface& blank = *floor_of(off);
  CHECK(blank.is_flat());
  for (const std::uint8_t value : blank.colour().data) CHECK(value == blank.colour().data.front());
  // 100 ms are three frames.
  for (std::size_t k = 0; k < late.frames.size(); ++k) {
    const session::Snapshot& then = truth().frames[k < 3 ? 0 : k - 3];
    CHECK(late.frames[k].balls.front().position == then.balls.front().position);
    CHECK(late.frames[k].pen_tip == (k < 3 ? std::optional<Vec3>() : then.pen_tip));
    CHECK(late.frames[k].time == truth().frames[k].time);
  }
}

TEST_CASE("cues: the hand gets no force, a late one, or another surface's") {
  for (const haptics::ServoSample& sample : played(both, "touch=off").recording.servo) {
    CHECK(sample.force == Vec3::Zero());
    CHECK(sample.wanted == Vec3::Zero());
  }
  const std::vector<Vec3> now = wanted_forces(truth()),
                          late = wanted_forces(played(both, "touch-delay=60ms"));
  double most = 0;
  for (std::size_t k = 0; k < late.size(); ++k)
    most = std::max(most, (late[k] - (k < 60 ? Vec3(Vec3::Zero()) : now[k - 60])).norm());
  CHECK(most < 1e-9);
  const std::string moved = "position = [0.01, 0, 0]\n", pebbles = "texture = \"pebbles\"\n";
  CHECK(wanted_forces(played(both, "touch-shift=10mm")) ==
        wanted_forces(played(head + moved + pen_table + ball_table)));
  CHECK(wanted_forces(played(both, "touch=pebbles")) ==
        wanted_forces(played(head + pebbles + pen_table + ball_table)));
}

TEST_CASE("cues: a delayed sound is the same samples later") {
  constexpr std::size_t late = 2646;  // 60 ms at 44100 Hz
  const std::vector<float>&now = truth().recording.stereo,
        then = played(both, "sound-delay=60ms").recording.stereo;
  REQUIRE(then.size() == now.size());
  CHECK(std::all_of(then.begin(), then.begin() + 2 * late, [](float sample) { return sample == 0; }));
  CHECK(std::equal(then.begin() + 2 * late, then.end(), now.begin()));
  // Where there is one sound only, its own delay is exact, too.
  const std::vector<float> alone = played(head + ball_table).recording.stereo,
                           alone_late = played(head + ball_table, "ball_sound-delay=60ms").recording.stereo;
  CHECK(peak(alone) > 1e-4);
  CHECK(std::equal(alone_late.begin() + 2 * late, alone_late.end(), alone.begin()));
}

TEST_CASE("cues: the pen's and the bodies' sounds are switched and delayed apart") {
  const std::vector<float> all = truth().recording.audio,
                           pen = played(both, "ball_sound=off").recording.audio,
                           ball = played(both, "pen_sound=off").recording.audio;
  CHECK(peak(played(both, "sound=off").recording.audio) == 0);
  CHECK(peak(pen) > 1e-5);
  // The ball's sound is that of a scene without the pen, and the two add up, but for the place from which the
  // floor is heard: where it was touched last.
  CHECK(largest_difference(ball, played(head + ball_table).recording.audio) == 0);
  CHECK(largest_difference(difference(all, ball), pen) < 0.01 * peak(pen));
  const std::vector<float> late_pen = difference(played(both, "pen_sound-delay=60ms").recording.audio, ball),
                           late_ball = difference(played(both, "ball_sound-delay=60ms").recording.audio, pen);
  CHECK(lag_of(pen, late_pen, 2640, 2652) == 2646);
  CHECK(lag_of(ball, late_ball, 2640, 2652) == 2646);
}

TEST_CASE("cues: bodies roll on nothing, late, or on another floor") {
  const std::string flat = "representation = \"flat\"\n", moved = "position = [0.01, 0, 0]\n",
                    pebbles = "texture = \"pebbles\"\n";
  const auto tracks = [](const Played& run) { return run.recording.tracks.front(); };
  const Played off = played(both, "motion=off");
  CHECK(tracks(off) == tracks(played(head + flat + pen_table + ball_table)));
  CHECK(tracks(played(both, "motion=pebbles")) == tracks(played(head + pebbles + pen_table + ball_table)));
  const Played shifted = played(both, "ball-shift=10mm"), elsewhere = played(head + moved + ball_table);
  CHECK(tracks(shifted) == tracks(elsewhere));
  // Contacts are named by the true floor's uv.
  const Played heard = played(head + ball_table, "ball-shift=10mm");
  for (const ContactEvent& event : heard.recording.events) {
    const surface::Placement& place = heard.surface.surface->placement();
    CHECK((event.uv - place.uv(place.to_local(event.point))).norm() < 1e-3);
  }
  const std::vector<Vec3> now = tracks(truth()), late = tracks(played(both, "motion-delay=100ms"));
  for (std::size_t k = 48; k < late.size(); ++k) CHECK(late[k] == now[k - 48]);
  CHECK(late.front().y() == doctest::Approx(0.06));
}

TEST_CASE("cues: sound takes the other texture at the place of the contact") {
  const Played run = played(both, "pen_sound=wood_planks,ball_sound-shift=10mmx5mm");
  const auto textures = scene::heard_textures(run.surface);
  REQUIRE(textures.size() == 3);
  session::HeardContacts heard(run.scene, run.surface, {});
  std::size_t pens = 0, balls = 0;
  for (const ContactEvent& event : run.recording.events) {
    heard.add(event, [&](const ContactEvent& changed) {
      const bool is_pen = event.body == run.recording.pen;
      (is_pen ? pens : balls) += 1;
      CHECK(changed.texture == (is_pen ? 1 : 2));
      CHECK(changed.time == event.time);
      const surface::Surface& texture = *textures[std::size_t(changed.texture)];
      const surface::Placement& there = texture.placement();
      const Vec3 place = truth().surface.surface->placement().to_world(
          {event.uv.x() * there.size_u(), event.uv.y() * there.size_v(), 0});
      CHECK((changed.uv - there.uv(there.to_local(place))).norm() < 1e-12);
    });
  }
  CHECK(pens > 100);
  CHECK(balls > 10);
  // The floor's own texture, and a shift by its period, are the truth.
  const std::vector<float> ball = played(head + ball_table).recording.audio;
  CHECK(played(head + ball_table, "ball_sound=brick").recording.audio == ball);
  CHECK(largest_difference(played(head + ball_table, "ball_sound-shift=1m").recording.audio, ball) <
        1e-6 * peak(ball));
}

TEST_CASE("cues: late values") {
  session::LateValues<int, char> late(3, '-');
  std::string seen;
  for (int now = 0; now < 8; ++now) {
    if (now % 2 == 0) late.put(now, char('a' + now));
    seen += late.at(now);
  }
  CHECK(seen == "---aacce");
  late.restart('z');
  CHECK(late.at(8) == 'z');
}

TEST_CASE("cues: an unknown texture is an error that names the cue's line") {
  scene::Scene scene = tests::parsed(head + "[cues.touch]\ntexture = \"brik\"\n");
  const auto made = scene::make_surface(scene);
  REQUIRE_FALSE(made);
  CHECK(made.error().message().find("s.toml:8: no built-in texture is called \"brik\"") == 0);
}
