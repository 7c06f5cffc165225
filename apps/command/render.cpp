// intaglio render SCENE -o OUT.mp4
#include <fmt/format.h>

#include <cstdlib>
#include <memory>

#include "command/verb.h"
#include "intaglio/representation.h"
#include "report/render_job.h"

namespace intaglio::app {

namespace {

struct RenderArguments {
  std::string scene;
  std::string output;
  std::string texture;
  std::string representation, green, polarity;
  double depth = -1;
  double duration = -1;
  int threads = 2;
  std::vector<std::string> faults;
};

// Options override the scene file.
void override_scene(const RenderArguments& options, scene::Scene& scene) {
  if (!options.texture.empty()) scene::put_texture(scene.surface, options.texture);
  if (options.representation == "flat") scene.surface.representation = Representation::flat;
  if (options.representation == "normal") scene.surface.representation = Representation::normal;
  if (options.representation == "relief") scene.surface.representation = Representation::relief;
  if (!options.green.empty()) scene.surface.green = parse_green(options.green);
  if (!options.polarity.empty()) scene.surface.polarity = parse_polarity(options.polarity);
  if (options.depth >= 0) scene.surface.depth = options.depth;
  if (options.duration > 0) scene.duration = options.duration;
  put_faults(options.faults, scene.cues);
}

void print_summary(const session::Run& run, const std::string& output) {
  fmt::print("{}\n  {:.1f} s of scene in {:.1f} s; modal analysis {:.1f} CPU-s\n", output, run.duration,
             run.wall_s, run.bake_s);
  if (const std::string note = scene::cue_note(run.cues); !note.empty()) fmt::print("  {}\n", note);
  for (const std::string& note : run.notes) fmt::print("  texture: {}\n", note);
  for (const std::string& warning : run.warnings) fmt::print("  warning: {}\n", warning);
  for (const session::SenseCost& cost : run.costs) {
    fmt::print("  {:9} {:>20}: median {:9.2f} us, p99 {:9.2f} us, {:6.2f} CPU-s\n", cost.sense, cost.step,
               cost.median_us, cost.p99_us, cost.total_s);
  }
  fmt::print("  events {} (hash {:016x}), sound hash {:016x}\n", run.event_count, run.event_hash,
             run.audio_hash);
}

int run_render(const RenderArguments& options, const Common& common) {
  auto scene = scene::read_scene(options.scene, common.allowed_memory);
  if (!scene) return report(scene.error());
  override_scene(options, *scene);
  // Mesa's llvmpipe draws with as many threads as this says; the user's setting wins. Set before any thread
  // starts that reads the environment.
  setenv("LP_NUM_THREADS", std::to_string(options.threads > 1 ? options.threads : 0).c_str(), 0);
  const auto run = report::render(*scene, {options.output, options.threads, common.quiet});
  if (!run) return report(run.error());
  if (!common.quiet) print_summary(*run, options.output);
  return 0;
}

}  // namespace

void add_render(CLI::App& app, Common& common) {
  CLI::App* verb =
      app.add_subcommand("render", "Render a scene to video with sound (offline, deterministic)");
  auto options = std::make_shared<RenderArguments>();
  verb->add_option("SCENE", options->scene, "Scene file (docs/scene.md)")->required();
  verb->add_option("-o,--output", options->output,
                   "The video, .mp4; beside it go .html (report), .wav, .events.csv, .servo.csv")
      ->required();
  verb->add_option("--surface", options->texture,
                   "Your own texture instead of the scene's: an image (normal, height or RGBA) or a folder");
  verb->add_option("--representation", options->representation, "How the texture is interpreted")
      ->check(CLI::IsMember({"flat", "normal", "relief"}));
  verb->add_option("--green", options->green,
                   "Sign of the normal map's green channel (+Y: OpenGL, -Y: DirectX)")
      ->check(CLI::IsMember({"+Y", "-Y"}));
  verb->add_option("--polarity", options->polarity, "Meaning of white in the height or alpha channel")
      ->check(CLI::IsMember({"height", "depth"}));
  verb->add_option("--depth", options->depth, "Full depth of the relief, metres")
      ->check(CLI::Range(0.0, 10.0));
  verb->add_option("--duration", options->duration, "Seconds of scene")->check(CLI::Range(0.1, 3600.0));
  add_fault_option(*verb, options->faults);
  verb->add_option(
          "--threads", options->threads,
          "1: one thread; 2 or more: frames are drawn in parallel with the simulation. The result is the same")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  verb->footer(
      "Example:\n  intaglio render scenes/brick.toml -o out/demo/brick.mp4\n  intaglio render "
      "scenes/brick.toml --surface my_wall/ --polarity height -o out/wall.mp4\n"
      "  intaglio render scenes/brick.toml --fault sound-delay=60ms -o out/late.mp4");
  verb->callback([options, &common] { common.exit_code = run_render(*options, common); });
}

}  // namespace intaglio::app
