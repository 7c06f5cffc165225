// A whole scene file, offline: its hash, its sound, its report, and its video when ffmpeg is there.
//
//   example_simulate_scene [SCENE.toml [FOLDER]]
#include <intaglio/report.h>
#include <intaglio/session.h>

#include <filesystem>
#include <iostream>

int main(int argc, char** argv) {
  const auto scene = argc > 1 ? intaglio::Scene::load(argv[1])
                              : intaglio::Scene::parse("duration = 0.5\n[[ball]]\nposition = [0, 0.2, 0]\n", "a ball");
  if (!scene) {
    std::cerr << scene.error() << '\n';
    return 1;
  }
  const auto recording = intaglio::simulate(*scene, {.progress = [](double done) { std::cerr << int(100 * done) << " %\r"; }});
  if (!recording) {
    std::cerr << recording.error() << '\n';
    return 1;
  }
  std::cout << recording->events().size() << " contact events, hash " << recording->hash() << '\n';
  if (argc < 3) return 0;
  const std::filesystem::path folder = argv[2];
  for (const auto& saved : {recording->save_audio(folder / "sound.wav"), recording->save_events(folder / "events.csv"),
                            recording->save_video(folder / "video.mp4"),
                            intaglio::save_report(*recording, folder / "report.html", {.video = folder / "video.mp4"})}) {
    if (saved) continue;
    std::cerr << saved.error() << '\n';
    return 1;
  }
}
