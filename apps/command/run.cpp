// intaglio run [SCENE]
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "command/stop.h"
#include "command/verb.h"
#include "core/file.h"
#include "window/application.h"

namespace intaglio::app {

namespace {

struct RunArguments {
  std::string scene, script, device, audio = "default", record_to, surface, shaders;
  int width = 0, height = 0;
  double scale = 0;
  bool json = false, fresh = false;
  std::vector<std::string> faults;
};

// The scene of `intaglio run` without a file: balls on brick.
constexpr const char* first_scene = R"(title = "Brick"
[surface]
texture = "brick"
[[ball]]
radius = 0.045
material = "steel"
position = [-0.25, 0.25, 0.1]
velocity = [0.5, 0, -0.1]
[[ball]]
radius = 0.06
material = "wood"
position = [0.2, 0.3, -0.15]
[[ball]]
radius = 0.03
material = "glass"
position = [0.1, 0.2, 0.2]
)";

// Checks that a folder exists or can be created; it is created by the first recording.
Result<void> check_folder(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path at = fs::absolute(folder, error);
  while (!fs::exists(at, error) && at.has_relative_path()) at = at.parent_path();
  if (fs::is_directory(at, error)) return {};
  return fail(folder, at == fs::absolute(folder, error) ? "is a file" : "has a file as parent",
              "--record-to takes a folder");
}

void print_report_json(const window::RunReport& r) {
  print_json(
      {{"seconds", r.seconds},
       {"start_seconds", r.start_seconds},
       {"driver", r.driver},
       {"audio_device", r.audio_device},
       {"frames",
        {{"count", r.frames.count},
         {"over_33_ms", r.frames.late},
         {"median_s", r.frames.median},
         {"p99_s", r.frames.p99},
         {"longest_s", r.frames.longest}}},
       {"touch",
        {{"ticks", r.touch.ticks},
         {"left_out", r.touch.skipped},
         {"wake_p99_s", r.touch.wake_p99},
         {"compute_p99_s", r.touch.compute_p99},
         {"priority", r.touch.priority}}},
       {"dynamics",
        {{"steps", r.dynamics.steps}, {"left_out", r.dynamics.skipped}, {"step_s", r.dynamics.step_seconds}}},
       {"sound",
        {{"buffers", r.sound.buffers},
         {"underruns", r.sound.underruns},
         {"events", r.sound.events},
         {"dropped", r.sound.dropped},
         {"busiest", r.sound.peak_load},
         {"delay_s", r.sound.delay}}},
       {"bodies_taken", r.bodies_dragged},
       {"was_baking", r.was_baking},
       {"gl_errors", r.gl_errors},
       {"gl_error_names", r.gl_error_names},
       {"messages", r.messages},
       {"written", r.files_written}});
}

void print_summary(const window::RunReport& r) {
  fmt::print("{:.1f} s on {}; first picture after {:.2f} s; OpenGL errors {}\n", r.seconds, r.driver,
             r.start_seconds, r.gl_errors);
  fmt::print("  picture   {} frames, median {:.1f} ms, p99 {:.1f} ms, {} over 33 ms\n", r.frames.count,
             1e3 * r.frames.median, 1e3 * r.frames.p99, r.frames.late);
  fmt::print("  dynamics  {} steps, {:.1f} us each, {} skipped\n", r.dynamics.steps,
             1e6 * r.dynamics.step_seconds, r.dynamics.skipped);
  fmt::print("  touch     {} ticks, {} skipped, wake-up p99 {:.0f} us, compute p99 {:.1f} us\n",
             r.touch.ticks, r.touch.skipped, 1e6 * r.touch.wake_p99, 1e6 * r.touch.compute_p99);
  fmt::print("  sound     {} buffers on {}, {} underruns, busiest {:.0f} %, {} events, {} dropped\n",
             r.sound.buffers, r.audio_device, r.sound.underruns, 100 * r.sound.peak_load, r.sound.events,
             r.sound.dropped);
  for (const std::string& message : r.messages) fmt::print("  message: {}\n", message);
}

// Prints how a run went; returns its exit code.
int print_end(const window::RunReport& done, const RunArguments& arguments, const Common& common) {
  if (done.frames.count == 0 && !done.messages.empty() && !interrupted)
    return report({"", done.messages.back(), ""});
  if (arguments.json) {
    print_report_json(done);
  } else if (!common.quiet) {
    print_summary(done);
  }
  return interrupted ? interrupted_code() : 0;
}

int run(const RunArguments& arguments, const Common& common) {
  window::RunOptions options;
  auto scene =
      arguments.scene.empty() ? scene::parse_scene(first_scene, "brick") : scene::read_scene(arguments.scene);
  if (!scene) return report(scene.error());
  scene->allowed_memory = common.allowed_memory;
  options.scene = std::move(*scene);
  options.scene_file = arguments.scene;
  if (!arguments.surface.empty()) scene::put_texture(options.scene.surface, arguments.surface);
  put_faults(arguments.faults, options.scene.cues);
  if (!arguments.script.empty()) {
    const auto bytes = read_file(arguments.script, 1u << 20);
    if (!bytes) return report(bytes.error());
    auto events =
        window::parse_script({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, arguments.script);
    if (!events) return report(events.error());
    options.script = std::move(*events);
  }
  if (!arguments.record_to.empty()) {
    if (auto checked = check_folder(arguments.record_to); !checked) return report(checked.error());
  }
  options.device = arguments.device;
  options.audio = arguments.audio;
  options.shaders = arguments.shaders;
  options.record_to = arguments.record_to;
  if (arguments.width > 0) options.width = arguments.width;
  if (arguments.height > 0) options.height = arguments.height;
  if (arguments.scale > 0) options.interface_scale = arguments.scale;
  options.keeps_settings = !arguments.fresh;
  options.interrupted = &interrupted;
  options.left = [] {
    if (!interrupted) end_soon(0);
  };
  end_gracefully();
  int code = 0;
  const auto ended = window::run(options, [&](const window::RunReport& done) {
    code = print_end(done, arguments, common);
    std::fflush(stdout);
    end_soon(code);
  });
  return ended ? code : report(ended.error());
}

}  // namespace

void add_run(CLI::App& app, Common& common) {
  CLI::App* verb =
      app.add_subcommand("run", "Run a scene interactively: see it, pull it, touch it, hear it, record it");
  auto arguments = std::make_shared<RunArguments>();
  verb->add_option("SCENE", arguments->scene, "Scene file (docs/scene.md); none: balls on brick");
  verb->add_option("--surface", arguments->surface,
                   "Your own texture instead of the scene's: an image or a folder");
  add_fault_option(*verb, arguments->faults);
  verb->add_option("--device", arguments->device,
                   "The pen: a VRPN device, NAME@HOST[:PORT]; none: the mouse");
  verb->add_option("--audio", arguments->audio, "Sound card: default, null (silent), or a part of its name")
      ->capture_default_str();
  verb->add_option("--script", arguments->script, "Scripted user input (docs/run.md)");
  verb->add_option("--width", arguments->width, "Window width, pixels; default: last run's")
      ->check(CLI::Range(16, 7680));
  verb->add_option("--height", arguments->height, "Window height, pixels; default: last run's")
      ->check(CLI::Range(16, 4320));
  verb->add_option("--scale", arguments->scale, "Panel scale: 1, 2, ...; default: from the display")
      ->check(CLI::Range(0.5, 4.0));
  verb->add_option(
          "--shaders", arguments->shaders,
          "Folder of shaders that replace the built-in ones of the same name, e.g. slab.frag; reloaded when they change")
      ->check(CLI::ExistingDirectory);
  verb->add_option("--record-to", arguments->record_to, "Folder of recordings (F9) and screenshots (F12)");
  verb->add_flag("--json", arguments->json,
                 "Print a JSON report on exit: deadlines of every sense, messages");
  verb->add_flag("--fresh", arguments->fresh, "Ignore and do not save window settings");
  verb->footer(
      "Examples:\n  intaglio run\n  intaglio run scenes/pinball.toml\n"
      "  SDL_VIDEODRIVER=offscreen intaglio run --script test.events --json");
  verb->callback([arguments, &common] { common.exit_code = run(*arguments, common); });
}

}  // namespace intaglio::app
