#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/hash.h"
#include "core/portable_math.h"
#include "sound/impact.h"
#include "sound/synthesizer.h"
#include "tests/count_allocations.h"
#include "tests/sound/samples.h"
#include "tests/sound/scenes.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::all_zero;
using test::bodies;
using test::contact;
using test::rms;
using test::step;
using test::tumble;

namespace {

std::vector<float> play(Synthesizer& synthesizer, const std::vector<ContactEvent>& events, double seconds,
                        std::size_t block = 441) {
  for (const ContactEvent& event : events) synthesizer.push(event);
  std::vector<float> out(std::size_t(seconds * 44'100));
  for (std::size_t done = 0; done < out.size(); done += block) {
    synthesizer.render(std::span(out).subspan(done, std::min(block, out.size() - done)));
  }
  return out;
}

std::vector<float> play(const SynthesizerOptions& options, const std::vector<ContactEvent>& events,
                        double seconds, std::size_t block = 441) {
  Synthesizer synthesizer(options, bodies());
  return play(synthesizer, events, seconds, block);
}

std::uint64_t hash_of(const std::vector<float>& samples) {
  Hash hash;
  hash.add(std::span<const float>(samples));
  return hash.value();
}

constexpr std::array<MesoSource, 2> both_modes{MesoSource::engine_impulses, MesoSource::normal_map};

}  // namespace

TEST_CASE("the same events give the same sound, however rendering is cut and however early events come") {
  for (const MesoSource meso : both_modes) {
    const SynthesizerOptions options{.meso = meso};
    const std::uint64_t hash = hash_of(play(options, tumble(), 1));
    CHECK(hash == hash_of(play(options, tumble(), 1)));
    CHECK(hash == hash_of(play(options, tumble(), 1, 64)));
    CHECK(hash == hash_of(play(options, tumble(), 1, 1000)));
    CHECK(hash == hash_of(play(options, tumble(), 1, 7)));
    // As in a live session: only the events of the next block are known.
    Synthesizer live(options, bodies());
    std::vector<float> out(44'100);
    const std::vector<ContactEvent> events = tumble();
    auto next = events.begin();
    for (std::size_t done = 0; done < out.size(); done += 100) {
      const double end = double(done + 100) / 44'100;
      for (; next != events.end() && next->time - next->duration <= end; ++next) live.push(*next);
      live.render(std::span(out).subspan(done, 100));
    }
    CHECK(hash == hash_of(out));
    CHECK(live.status().late_events == 0);
    const SynthesizerOptions other{.seed = 2, .meso = meso};
    CHECK(hash != hash_of(play(other, tumble(), 1)));
  }
}

TEST_CASE("pairs may report at different rates: a long step does not wait behind short ones") {
  std::vector<SoundBody> all = bodies();
  all.push_back(all[1]);
  all[2].id = 8;
  std::vector<ContactEvent> slow = tumble(), fast;
  for (int k = 1; k < 900; ++k) {
    ContactEvent event = contact(1, 0.0003 * (1 + k % 3));
    event.body = 8;
    event.time = k * 1e-3;
    event.duration = 1e-3;
    fast.push_back(event);
  }
  const auto in_order_of = [&](auto key) {
    std::vector<ContactEvent> events = slow;
    events.insert(events.end(), fast.begin(), fast.end());
    std::stable_sort(events.begin(), events.end(),
                     [&](const auto& a, const auto& b) { return key(a) < key(b); });
    Synthesizer synthesizer({}, all);
    return play(synthesizer, events, 1);
  };
  const auto by_end = in_order_of([](const ContactEvent& e) { return e.time; });
  const auto by_start = in_order_of([](const ContactEvent& e) { return e.time - e.duration; });
  // Equal except for the order in which floats are added.
  float worst = 0;
  for (std::size_t i = 0; i < by_end.size(); ++i) worst = std::max(worst, std::abs(by_end[i] - by_start[i]));
  CHECK(worst < 1e-5 * *std::max_element(by_end.begin(), by_end.end()));
}

TEST_CASE("without events there is exact silence, and so there is for a body at rest") {
  for (const MesoSource meso : both_modes) {
    Synthesizer synthesizer({.meso = meso}, bodies());
    CHECK(all_zero(play(synthesizer, {}, 0.1)));
    // Set down gently, it lies for five seconds, its solver not quite quiet.
    std::vector<ContactEvent> events;
    for (int k = 60; k < 2400; ++k) {
      events.push_back(
          contact(k, 0.001 * (1 + 1e-4 * (k % 3)), 0, k == 60 ? ContactPhase::begin : ContactPhase::persist));
    }
    const std::vector<float> out = play(synthesizer, events, 4.8);
    CHECK(rms(std::span(out).first(44'100)) > 0);
    CHECK(all_zero(std::span(out).last(22'050)));
  }
}

TEST_CASE("a blow sounds at once, when it should, and dies away to exact silence") {
  Synthesizer synthesizer({}, bodies());
  const std::vector<float> out = play(synthesizer, {contact(48, 0.05, 0, ContactPhase::begin)}, 6);
  const auto first = std::find_if(out.begin(), out.end(), [](float x) { return x != 0; }) - out.begin();
  CHECK(double(first) / 44'100 == doctest::Approx(48 * step - step / 2).epsilon(1e-3));
  CHECK(*std::max_element(out.begin(), out.end()) > 0.01);
  CHECK(all_zero(std::span(out).last(1000)));
  CHECK(synthesizer.is_silent());
}

TEST_CASE("a bounce is one blow: no second one when the contact ends, reported or not") {
  const std::vector<float> unsaid = play({}, {contact(10, 0.05, 0, ContactPhase::begin)}, 0.5);
  const std::vector<float> said =
      play({}, {contact(10, 0.05, 0, ContactPhase::begin), contact(11, 0, 0, ContactPhase::end)}, 0.5);
  CHECK(hash_of(said) == hash_of(unsaid));
}

TEST_CASE("a lift-off strikes once; a body that falls asleep in contact does not") {
  const auto lying = [](double speed) {
    std::vector<ContactEvent> events;
    for (int k = 1; k <= 960; ++k)
      events.push_back(contact(k, 0.002, speed, k == 1 ? ContactPhase::begin : ContactPhase::persist));
    return events;
  };
  const auto after = [](const std::vector<float>& out) { return rms(std::span(out).subspan(88'300, 4000)); };
  const auto before = [](const std::vector<float>& out) { return rms(std::span(out).subspan(83'000, 4000)); };
  std::vector<ContactEvent> events = lying(0);
  events.push_back(contact(961, 0, 0, ContactPhase::end));
  const std::vector<float> lifted = play({}, events, 4);
  CHECK(after(lifted) > 100 * before(lifted));
  // Creeping as it falls asleep, it still makes its fine noise; that dies away without a click.
  const std::vector<float> asleep = play({}, lying(0.001), 4);
  CHECK(before(asleep) > 0);
  CHECK(after(asleep) < before(asleep));
  CHECK(after(asleep) < 0.1 * after(lifted));
  CHECK(all_zero(std::span(asleep).last(4410)));
}

TEST_CASE("twice the drive gives twice the sound") {
  // Twice the body as well, so that speeds and with them contact times stay.
  // A click depends on the speed alone: bodies without area have none.
  const auto without_click = [] {
    std::vector<SoundBody> all = bodies();
    auto model = std::make_shared<ModalModel>(*all[1].model);
    model->area = 0;
    all[1].model = model;
    return all;
  };
  Synthesizer light({}, without_click());
  const std::vector<float> once = play(light, tumble(1), 1);
  std::vector<SoundBody> heavy = without_click();
  const double same_time = heavy[1].mass;
  heavy[1].mass *= 2;
  // Hertz: tau^5 scales as m^2 / (R v), and v = J / m is unchanged.
  heavy[1].radius_of_curvature *= std::pow(heavy[1].mass / same_time, 2);
  Synthesizer synthesizer({}, heavy);
  const std::vector<float> twice = play(synthesizer, tumble(2), 1);
  double worst = 0, peak = 0;
  for (std::size_t i = 0; i < once.size(); ++i) {
    worst = std::max(worst, double(std::abs(twice[i] - 2 * once[i])));
    peak = std::max(peak, double(std::abs(twice[i])));
  }
  CHECK(worst < 1e-4 * peak);
}

TEST_CASE("a harder blow is brighter: more of its energy lies high") {
  const auto brightness = [](double impulse) {
    const std::vector<float> out = play({}, {contact(10, impulse, 0, ContactPhase::begin)}, 0.5);
    std::vector<float> difference(out.size() - 1);
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = out[i + 1] - out[i];
    return rms(difference) / rms(out);
  };
  CHECK(brightness(0.2) > 1.05 * brightness(0.002));
}

TEST_CASE("the normal map sounds only where it is not flat, and louder the steeper it is") {
  const auto loudness = [](double slope) {
    Synthesizer synthesizer({.meso = MesoSource::normal_map, .micro_level = 0}, bodies(slope));
    std::vector<ContactEvent> events;
    for (int k = 1; k < 1440; ++k) events.push_back(contact(k, 0.001, 0.3));
    const std::vector<float> out = play(synthesizer, events, 2.99);
    return rms(std::span(out).last(22'050));  // long after the landing
  };
  CHECK(loudness(0) < 1e-3 * loudness(0.2));
  CHECK(loudness(0.4) > 1.3 * loudness(0.2));
}

TEST_CASE("micro noise needs speed and force, follows both, and can be switched off") {
  const auto loudness = [](double force, double speed, double level) {
    std::vector<ContactEvent> events;
    for (int k = 1; k < 1440; ++k) events.push_back(contact(k, force * step, speed));
    const std::vector<float> out = play({.micro_level = level}, events, 2.99);
    return rms(std::span(out).last(22'050));  // long after the landing
  };
  const double reference = loudness(0.5, 0.3, 0.3);
  CHECK(reference > 0);
  CHECK(loudness(1, 0.3, 0.3) == doctest::Approx(2 * reference).epsilon(0.1));
  CHECK(loudness(0.5, 0.3, 0.6) == doctest::Approx(2 * reference).epsilon(0.1));
  CHECK(loudness(0.5, 0, 0.3) < 1e-2 * reference);
  CHECK(loudness(0.5, 0.3, 0) < 1e-2 * reference);
}

TEST_CASE("rendering does not allocate, whatever happens") {
  for (const MesoSource meso : both_modes) {
    Synthesizer synthesizer({.meso = meso, .max_pulses = 16}, bodies());
    for (const ContactEvent& event : tumble()) synthesizer.push(event);
    std::vector<float> out(44'100);
    const std::size_t before = allocations();
    synthesizer.render(out);
    CHECK(allocations() == before);
  }
}

TEST_CASE("limits hold and are counted: pulses, path length, late events, unknown bodies") {
  Synthesizer crowded({.max_pulses = 2}, bodies());
  std::vector<ContactEvent> events;
  for (int k = 0; k < 8; ++k) {
    ContactEvent event = contact(10, 0.01 * (k + 1), 0, ContactPhase::begin);
    event.time += 1e-5 * k;  // each a step of its own
    events.push_back(event);
  }
  play(crowded, events, 0.1);
  CHECK(crowded.status().dropped_pulses > 0);

  Synthesizer far({.meso = MesoSource::normal_map}, [] {
    auto all = bodies();
    surface::Texels texels;
    texels.width = texels.height = 2048;
    texels.normal.assign(2048u * 2048u, Vec3::UnitZ());
    all[0].textures = {std::make_shared<surface::Surface>(
        std::move(texels), surface::Placement(Vec3::Zero(), Quat::Identity(), 0.5, 0.5), 0.001,
        surface::Edge::wrap)};
    return all;
  }());
  ContactEvent later = contact(2, 0.001, 1);
  later.uv.x() += 0.2;
  play(far, {contact(1, 0.001, 1, ContactPhase::begin), later}, 0.1);
  CHECK(far.status().truncated_paths == 1);

  Synthesizer late({}, bodies());
  play(late, {}, 0.5);
  const std::vector<float> heard = play(late, {contact(10, 0.05, 0, ContactPhase::begin)}, 0.1);
  CHECK(late.status().late_events == 1);
  CHECK(rms(heard) > 0);

  ContactEvent stranger = contact(1, 1);
  stranger.body = 99;
  late.push(stranger);
  CHECK(late.status().unknown_bodies == 1);
}

TEST_CASE("bodies without a model are silent but still strike") {
  std::vector<SoundBody> mute = bodies();
  mute[1].model = nullptr;
  Synthesizer half({}, mute);
  CHECK(rms(play(half, tumble(), 1)) > 0);
  mute[0].model = nullptr;
  Synthesizer none({}, mute);
  CHECK(all_zero(play(none, tumble(), 1)));
}

TEST_CASE("the pool keeps the largest pulses and gives places back") {
  PulsePool pool(2, 3);
  CHECK(pool.add({{0, 1}, 1.0, 0}).size() == 3);
  CHECK(pool.add({{0, 2}, -3.0, 0}).size() == 3);
  CHECK(pool.add({{0, 1}, 0.5, 0}).empty());
  CHECK_FALSE(pool.add({{0, 1}, 2.0, 0}).empty());
  CHECK(pool.dropped() == 2);
  CHECK(std::abs(pool.pulse(0).impulse) + std::abs(pool.pulse(1).impulse) == 5);
  pool.remove_ended(1);
  CHECK(pool.size() == 1);
  CHECK(pool.pulse(0).impulse == -3);
  CHECK_FALSE(pool.add({{0, 1}, 0.1, 0}).empty());
}
