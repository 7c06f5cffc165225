// intaglio sound strike | scrape | roll | drop | page | devices
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <thread>

#include "command/verb.h"
#include "core/file.h"
#include "core/text.h"
#include "core/toml.h"
#include "report/sound_page.h"
#include "session/simulation.h"
#include "sound/audio/devices.h"
#include "sound/audio/wav.h"
#include "sound/live_sound.h"
#include "sound/modal_model.h"
#include "sound/model_file.h"
#include "sound/strike.h"
#include "sound/synthesizer.h"

namespace intaglio::app {

namespace {

constexpr double max_duration = 30;  // s
constexpr double lead_in = 0.05;     // s of silence before a strike
constexpr int sample_rate = 44'100;  // of Synthesizer and write_wav, by default

struct StrikeArguments {
  std::string model, mallet = "wood", output, device = "default";
  std::vector<double> at, direction;
  std::optional<int> vertex;
  std::optional<double> impulse;
  double mallet_radius = 0.01, speed = 1, scale = 1, gain_db = 0;
  bool live = false;
};

double sound_level_db(double pascal) {
  return 20 * std::log10(std::max(pascal, 1e-12) / 20e-6);
}

// The strike from the options.
Result<sound::Strike> read_strike(const StrikeArguments& options, const sound::ModalModel& model) {
  const auto vec = [](const std::vector<double>& x) { return Vec3(x[0], x[1], x[2]); };
  sound::Strike strike;
  const auto material = load_material(options.mallet);
  if (!material) return tl::unexpected(material.error());
  strike.mallet = {*material, options.mallet_radius};
  if (!options.at.empty()) strike.at = vec(options.at);
  if (options.vertex) {
    const auto count = int(model.points.size());
    if (*options.vertex >= count) {
      return fail(options.model, fmt::format("has no vertex {}", *options.vertex),
                  fmt::format("it has {}, numbered from 0", count));
    }
    strike.at = model.points[std::size_t(*options.vertex)];
  }
  if (!options.direction.empty()) strike.direction = vec(options.direction);
  if (strike.direction && !(strike.direction->norm() > 1e-9 && strike.direction->norm() < 1e9))
    return fail("--direction", "must be a non-zero vector", "give three numbers, the largest about 1");
  strike.impulse = options.impulse;
  if (!strike.impulse) {
    const double unit = sound::strike_event(model, strike, 0).impulse.norm();
    strike.impulse = unit * options.speed;
  }
  return strike;
}

Result<void> check_wav(const std::string& output) {
  auto named = check_extension(output, ".wav", "a WAV file");
  return named ? check_writable(output) : named;
}

double peak_of(const std::vector<float>& audio) {
  double peak = 0;
  for (const float x : audio) peak = std::max(peak, double(std::abs(x)));
  return peak;
}

// Renders until silent; Pa at 1 m.
std::vector<float> render_strike(const std::shared_ptr<const sound::ModalModel>& model,
                                 const sound::Strike& strike) {
  sound::Synthesizer synthesizer({}, sound::strike_bodies(model, strike));
  synthesizer.push(sound::strike_event(*model, strike, lead_in));
  std::vector<float> audio;
  std::array<float, 441> block;
  do {
    synthesizer.render(block);
    audio.insert(audio.end(), block.begin(), block.end());
  } while (!synthesizer.is_silent() && synthesizer.time() < max_duration);
  return audio;
}

int play_live(const std::shared_ptr<const sound::ModalModel>& model, const sound::Strike& strike,
              const StrikeArguments& options, double seconds, const Common& common) {
  auto opened = sound::open_audio_device({options.device});
  if (!opened) return report(opened.error());
  sound::AudioDevice& device = *opened->device;
  if (!opened->note.empty()) print_error(fmt::format("intaglio: {}\n", opened->note));
  sound::LiveSound live({.sample_rate = double(device.sample_rate())}, sound::strike_bodies(model, strike),
                        {.gain_db = options.gain_db});
  live.set_listener({model->points.front() + Vec3::UnitZ(), Vec3::UnitX()});
  if (auto started = device.start(live); !started) return report(started.error());
  live.push(sound::strike_event(*model, strike, lead_in));
  live.advance(2 * lead_in);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end && device.status().error.empty())
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const sound::AudioStatus status = device.status();
  device.stop();
  if (!status.error.empty()) return report({"sound", status.error, ""});
  if (!common.quiet) {
    fmt::print(
        "{}: {} Hz, buffers of {} frames, latency {:.1f} ms; {} underruns in {} buffers, at most {:.0f} % of a "
        "buffer's time busy\n",
        device.name(), device.sample_rate(), device.buffer_frames(), 1000 * status.latency, status.underruns,
        status.buffers, 100 * status.peak_load);
  }
  return 0;
}

int run_strike(const StrikeArguments& options, const Common& common) {
  if (options.output.empty() && !options.live)
    return report({"intaglio sound strike", "no output given", "give -o FILE.wav, or --live"});
  if (!options.output.empty()) {
    if (auto writable = check_wav(options.output); !writable) return report(writable.error());
  }
  auto read = sound::read_model(options.model);
  if (!read) return report(read.error());
  if (read->modes() == 0)
    return report({options.model, "has no mode below 20 kHz", "bake a larger or softer body"});
  const auto model = std::make_shared<const sound::ModalModel>(
      options.scale == 1 ? std::move(*read) : sound::scaled(*read, options.scale));
  if (model->modes() == 0)
    return report({options.model, "has no mode at that scale", "give a smaller --scale"});
  const auto strike = read_strike(options, *model);
  if (!strike) return report(strike.error());
  std::vector<float> audio = render_strike(model, *strike);
  const double peak = peak_of(audio);
  if (!common.quiet) {
    const Vec3 at = sound::strike_event(*model, *strike, 0).point;
    fmt::print(
        "{}: {} modes from {:.1f} Hz, struck at {:.4g},{:.4g},{:.4g} with {:.3g} N s; {:.0f} dB SPL peak at 1 m, "
        "{:.1f} s\n",
        options.model, model->modes(), model->angular_frequency[0] / (2 * std::numbers::pi), at.x(), at.y(),
        at.z(), *strike->impulse, sound_level_db(peak), double(audio.size()) / sample_rate);
  }
  if (options.live) {
    if (const int code = play_live(model, *strike, options, double(audio.size()) / sample_rate + 0.1, common);
        code != 0)
      return code;
  }
  if (options.output.empty()) return 0;
  sound::to_full_scale(audio, audio, {options.gain_db});
  if (auto written = sound::write_wav(options.output, audio, sample_rate); !written)
    return report(written.error());
  return 0;
}

int run_touch(report::TouchKind touch, const std::string& texture, const std::string& output, double gain_db,
              const Common& common) {
  if (auto writable = check_wav(output); !writable) return report(writable.error());
  scene::Scene scene = report::touch_scene(touch, texture);
  scene.sound.gain_db = gain_db;
  const auto recording = session::play(scene);
  if (!recording) return report(recording.error());
  const double peak = peak_of(recording->audio);
  if (!common.quiet) {
    fmt::print("{}: {:.1f} s, {} contacts, {:.0f} dB SPL peak half a metre away{}\n", output,
               recording->duration, recording->events.size(),
               sound_level_db(peak * sound::full_scale_pascal / std::pow(10, gain_db / 20)),
               gain_db == 0 ? "" : fmt::format(", {:+.0f} dB in the file", gain_db));
  }
  if (auto written = sound::write_wav(output, recording->stereo, recording->sample_rate, {.channels = 2});
      !written)
    return report(written.error());
  return 0;
}

int list_devices() {
  const std::vector<sound::SoundCard> cards = sound::sound_cards();
  for (const sound::SoundCard& card : cards) {
    fmt::print("{}: {}{}, {} channels, {} Hz preferred\n", card.api, card.name,
               card.is_default ? " (default)" : "", card.channels, card.preferred_rate);
  }
  if (cards.empty()) fmt::print("no audio device on this machine\n");
  fmt::print("null: silent, real-time, always available\n");
  return 0;
}

void add_strike(CLI::App& sound, Common& common) {
  CLI::App* verb =
      sound.add_subcommand("strike", "Strike a baked model once (free boundary) and play or save it");
  auto options = std::make_shared<StrikeArguments>();
  verb->add_option("MODEL", options->model, "A model that `intaglio bake` wrote")->required();
  verb->add_option("-o,--output", options->output,
                   "A WAV file: one channel, 24 bits, full scale 20 Pa at 1 m");
  auto* live = verb->add_flag("--live", options->live, "Play it");
  verb->add_option("--device", options->device,
                   "A part of a name that `intaglio sound devices` lists, or null")
      ->needs(live)
      ->capture_default_str();
  auto* at =
      verb->add_option("--at", options->at,
                       "Strike point x,y,z, in the model's metres, moved to its surface; default: where many "
                       "modes respond")
          ->delimiter(',')
          ->expected(3)
          ->check(CLI::Range(-1e4, 1e4));
  verb->add_option("--vertex", options->vertex, "Strike point: a vertex of the model's surface, from 0")
      ->check(CLI::Range(0, std::numeric_limits<int>::max()))
      ->excludes(at);
  verb->add_option("--direction", options->direction, "Impulse direction x,y,z; default: into the surface")
      ->delimiter(',')
      ->expected(3);
  verb->add_option("--mallet", options->mallet,
                   "Mallet material: a built-in name or a TOML file; hard, light ones sound bright")
      ->capture_default_str();
  verb->add_option("--mallet-radius", options->mallet_radius, "Mallet ball radius, m")
      ->check(CLI::Range(1e-4, 1.0))
      ->capture_default_str();
  auto* speed = verb->add_option("--speed", options->speed, "Impact speed, m/s")
                    ->check(CLI::Range(1e-3, 100.0))
                    ->capture_default_str();
  verb->add_option("--impulse", options->impulse, "Impulse, N s, instead of a speed")
      ->check(CLI::Range(1e-9, 1e4))
      ->excludes(speed);
  verb->add_option("--scale", options->scale, "Scale of the body's size (no rebake)")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  verb->add_option("--gain-db", options->gain_db, "dB on top of the calibrated level")
      ->check(CLI::Range(-120.0, 120.0))
      ->capture_default_str();
  verb->footer(
      "Examples:\n"
      "  intaglio bake plate:a=0.3,t=0.01 --material ceramic -o out/tile.modes\n"
      "  intaglio sound strike out/tile.modes -o out/tile.wav\n"
      "  intaglio sound strike out/tile.modes --mallet steel --speed 2 --at 0.1,0.005,0 --live\n"
      "Hertz' theory gives the contact time, from both materials, the mallet's radius and the speed.");
  verb->callback([options, &common] { common.exit_code = run_strike(*options, common); });
}

void add_touch(CLI::App& sound, Common& common, report::TouchKind touch, const char* name, const char* help) {
  CLI::App* verb = sound.add_subcommand(name, help);
  struct TouchArguments {
    std::string texture, output;
    double gain_db = 0;
  };
  auto options = std::make_shared<TouchArguments>();
  verb->add_option("TEXTURE", options->texture,
                   "A built-in name, a recipe (.toml), an image or a folder of images")
      ->required();
  verb->add_option("-o,--output", options->output, "A WAV file: stereo, 24 bits")->required();
  verb->add_option("--gain-db", options->gain_db,
                   "dB on top of the calibrated level; use 20 to 40 for quiet sounds")
      ->check(CLI::Range(-120.0, 120.0))
      ->capture_default_str();
  verb->footer(fmt::format("Example:\n  intaglio sound {0} brick_running -o out/{0}.wav --gain-db 20", name));
  verb->callback([options, touch, &common] {
    common.exit_code = run_touch(touch, options->texture, options->output, options->gain_db, common);
  });
}

void add_page(CLI::App& sound, Common& common) {
  CLI::App* verb =
      sound.add_subcommand("page",
                           "Make a page of players and spectrograms: built-in textures struck, scraped "
                           "and rolled on");
  auto job = std::make_shared<report::SoundPageJob>();
  verb->add_option("-o,--output", job->folder, "A folder; gets index.html, .mp3 and .png files")->required();
  verb->add_option("TEXTURE", job->textures, "Textures; default: all built-in ones");
  verb->footer(
      "Example:\n  intaglio sound page -o out/heard brick_running metal_mesh\nA sound takes a few seconds.");
  verb->callback([job, &common] {
    job->quiet = common.quiet;
    if (auto made = report::make_sound_page(*job); !made) common.exit_code = report(made.error());
  });
}

}  // namespace

void add_sound(CLI::App& app, Common& common) {
  CLI::App* verb = app.add_subcommand("sound", "Hear models and textures; list audio devices");
  verb->require_subcommand(1);
  add_strike(*verb, common);
  add_touch(*verb, common, report::TouchKind::strike, "drop", "A wooden ball falls on a texture");
  add_touch(*verb, common, report::TouchKind::scrape, "scrape", "A wooden pen is dragged over a texture");
  add_touch(*verb, common, report::TouchKind::roll, "roll", "A steel ball rolls over a texture");
  add_page(*verb, common);
  verb->add_subcommand("devices", "The audio devices of this machine")->callback([&common] {
    common.exit_code = list_devices();
  });
}

}  // namespace intaglio::app
