// Sound while it happens: a steel ball on bricks, physics in this thread, samples in the sound card's.
//
//   example_live_sound [DEVICE]        "null" by default, which nobody hears; "default" is the system's card
#include <intaglio/audio.h>
#include <intaglio/bake.h>
#include <intaglio/world.h>

#include <chrono>
#include <iostream>
#include <thread>

using namespace intaglio;

int main(int argc, char** argv) {
  const auto wall = Surface::load("brick", {.size = {1, 1}}).value();
  const auto ball_model = bake(Sphere{0.1}, "steel", {.modes = 20});
  const auto slab_model = bake(Box{{0.5, 0.025, 0.5}}, "brick", {.modes = 20, .max_elements = 2000});
  if (!ball_model || !slab_model) {
    std::cerr << (ball_model ? slab_model : ball_model).error() << '\n';
    return 1;
  }
  auto world = World::create({.floor = wall}).value();
  const BodyId ball = world.add(Sphere{0.1}, {.material = "steel", .position = {0, 0.3, 0}}).value();

  auto card = AudioOutput::open({.device = argc > 1 ? argv[1] : "null"});
  if (!card) {
    std::cerr << card.error() << '\n';
    return 1;
  }
  auto sound =
      LiveSound::create({.sample_rate = double(card->sample_rate())},
                        {{.id = floor_body, .model = *slab_model, .surfaces = {wall}, .is_fixed = true},
                         {.id = ball, .model = *ball_model, .mass = world.mass(ball)}})
          .value();
  if (const auto started = card->start(sound); !started) {
    std::cerr << started.error() << '\n';
    return 1;
  }
  const auto start = std::chrono::steady_clock::now();
  while (world.time() < 1) {
    world.step();
    for (const ContactEvent& event : world.events()) sound.push(event);
    sound.advance(world.time());
    std::this_thread::sleep_until(start + std::chrono::duration<double>(world.time()));
  }
  card->stop();
  const LiveSoundStatus status = sound.status();
  std::cout << card->name() << ": " << status.events << " events, " << card->status().buffers << " buffers\n";
  return status.events > 0 && status.dropped_events == 0 ? 0 : 1;
}
