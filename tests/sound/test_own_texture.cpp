// A body's own texture sounds as the floor's does: only the speed at which the contact sweeps over it
// matters.
#include <doctest/doctest.h>

#include <cmath>

#include "sound/synthesizer.h"
#include "tests/sound/scenes.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::contact;

namespace {

constexpr int steps = 240;

enum class Where { floor, ball, second_of_ball };

std::vector<SoundBody> bodies_with(Where where) {
  std::vector<SoundBody> bodies = test::bodies();
  if (where != Where::floor) std::swap(bodies[0].textures, bodies[1].textures);
  if (where == Where::second_of_ball) bodies[1].textures.insert(bodies[1].textures.begin(), test::grooves(0));
  return bodies;
}

// A contact that moves along x at 0.4 m/s over the texture, on either body, while both roll.
ContactEvent rolling(int k, Where where) {
  ContactEvent event = contact(k, 0.002, 0.4, k == 1 ? ContactPhase::begin : ContactPhase::persist);
  event.spin = -event.v_t;
  if (where == Where::floor) return event;
  event.own = TexturePlace{where == Where::ball ? 0 : 1, event.uv, {0.4, 0}};
  return event;
}

std::vector<float> heard(MesoSource meso, Where where, const std::vector<ContactEvent>& events) {
  Synthesizer synthesizer({.meso = meso, .micro_level = 0}, bodies_with(where));
  for (const ContactEvent& event : events) synthesizer.push(event);
  std::vector<float> out(std::size_t(44'100 * (steps + 5) * test::step));
  synthesizer.render(out);
  return out;
}

std::vector<ContactEvent> roll(Where where) {
  std::vector<ContactEvent> events;
  for (int k = 1; k <= steps; ++k) events.push_back(rolling(k, where));
  return events;
}

double energy(const std::vector<float>& audio, std::size_t from = 0) {
  double sum = 0;
  for (std::size_t k = from; k < audio.size(); ++k) sum += double(audio[k]) * audio[k];
  return sum;
}

}  // namespace

TEST_CASE("a ball's own texture sounds as the same texture of the floor does, also its second one") {
  for (const MesoSource meso : {MesoSource::engine_impulses, MesoSource::normal_map, MesoSource::height}) {
    const auto of_floor = heard(meso, Where::floor, roll(Where::floor));
    CHECK(energy(of_floor, 2000) > 0);
    CHECK(of_floor == heard(meso, Where::ball, roll(Where::ball)));
    CHECK(of_floor == heard(meso, Where::second_of_ball, roll(Where::second_of_ball)));
  }
}

TEST_CASE("what is dragged does not sound of its own texture, what spins on the spot only of that") {
  std::vector<ContactEvent> dragged = roll(Where::ball), spinning = dragged, smooth = dragged;
  for (ContactEvent& event : dragged) {
    event.spin.setZero();
    event.own->uv = {0.3, 0.4};
    event.own->sweep.setZero();
  }
  for (ContactEvent& event : spinning) event.v_t.setZero();
  for (ContactEvent& event : smooth) event.own.reset();
  const auto of = [](const auto& events) { return heard(MesoSource::normal_map, Where::ball, events); };
  CHECK(of(dragged) == of(smooth));
  CHECK(energy(of(spinning), 2000) > 0);
  CHECK(of(spinning) == of(roll(Where::ball)));
}

TEST_CASE("across the seam of a texture that wraps round its body, the path continues") {
  // 128 texels of the same few values: any whole number of their period later it is the same texture.
  const auto shifted = [](double by) {
    std::vector<ContactEvent> events;
    for (int k = 1; k <= 60; ++k) {
      ContactEvent event = rolling(k, Where::ball);
      const double u = 0.4 * k * test::step / 0.5 + by;
      event.own->uv = {u - std::floor(u), 0.4};
      events.push_back(event);
    }
    return events;
  };
  const auto middle = heard(MesoSource::normal_map, Where::ball, shifted(0.2)),
             seam = heard(MesoSource::normal_map, Where::ball, shifted(0.95));
  CHECK(energy(seam) == doctest::Approx(energy(middle)).epsilon(0.3));
  // Shifted back by whole turns, it is the same path.
  std::vector<ContactEvent> unwrapped = shifted(0.95);
  for (ContactEvent& event : unwrapped)
    if (event.own->uv.x() < 0.5) event.own->uv.x() += 1;
  const auto straight = heard(MesoSource::normal_map, Where::ball, unwrapped);
  double most = 0, difference = 0;
  for (std::size_t k = 0; k < seam.size(); ++k) {
    most = std::max(most, std::abs(double(seam[k])));
    difference = std::max(difference, std::abs(double(seam[k]) - double(straight[k])));
  }
  CHECK(difference < 1e-3 * most);
}

TEST_CASE("two textures at once: both are heard, and one alone is what it was") {
  std::vector<ContactEvent> events = roll(Where::ball);
  const auto alone = heard(MesoSource::height, Where::ball, events);
  auto both_bodies = test::bodies();
  both_bodies[1].textures = both_bodies[0].textures;
  Synthesizer synthesizer({.meso = MesoSource::normal_map, .micro_level = 0}, both_bodies);
  for (const ContactEvent& event : events) synthesizer.push(event);
  std::vector<float> both(alone.size());
  synthesizer.render(both);
  const auto one = heard(MesoSource::normal_map, Where::ball, events);
  // The same path over the same texture: every impulse comes twice.
  CHECK(energy(both, 2000) == doctest::Approx(4 * energy(one, 2000)).epsilon(0.05));
}
