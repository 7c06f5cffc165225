// Sound from events: a ball that is struck. No physics engine, no sound card.
//
//   example_struck_ball MODEL.modes        from example_bake_ball or `intaglio bake`
#include <intaglio/sound.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cout << "usage: example_struck_ball MODEL.modes\n";
    return 0;
  }
  const auto model = intaglio::ModalModel::load(argv[1]);
  if (!model) {
    std::cerr << model.error() << '\n';
    return 1;
  }
  auto synth = intaglio::Synthesizer::create({.sample_rate = 48000}, {{.id = 1, .model = *model, .mass = model->mass()},
                                                                      {.id = intaglio::floor_body, .is_fixed = true}});
  if (!synth) {
    std::cerr << synth.error() << '\n';
    return 1;
  }
  intaglio::ContactEvent blow;  // what a physics engine would report
  blow.time = 0.01;
  blow.duration = 1.0 / 480;
  blow.body = 1;
  blow.impulse = {0, 0.1, 0};
  synth->push(blow);

  std::vector<float> samples(48000);
  synth->render(samples);
  const auto loudest = std::max_element(samples.begin(), samples.end(),
                                        [](float a, float b) { return std::abs(a) < std::abs(b); });
  std::cout << "peak " << std::abs(*loudest) << " Pa at 1 m, after " << double(loudest - samples.begin()) / 48000 << " s\n";
  return *loudest == 0 ? 1 : 0;
}
