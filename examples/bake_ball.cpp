// What does a ball ring like? Bakes a modal model and writes it.
//
//   example_bake_ball [MODEL.modes]
#include <intaglio/bake.h>

#include <iostream>

int main(int argc, char** argv) {
  const auto model = intaglio::bake(intaglio::Sphere{0.1}, "steel", {.name = "ball", .modes = 30});
  if (!model) {
    std::cerr << model.error() << '\n';
    return 1;
  }
  std::cout << model->modes() << " modes of " << model->mass() << " kg:\n";
  for (int m = 0; m < model->modes(); ++m)
    std::cout << "  " << model->frequency(m) << " Hz, T60 " << model->decay_time(m) << " s\n";
  if (argc > 1) {
    if (const auto saved = model->save(argv[1]); !saved) {
      std::cerr << saved.error() << '\n';
      return 1;
    }
  }
}
