#include "report/sound_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "core/file.h"
#include "core/output_files.h"
#include "core/progress.h"
#include "report/html.h"
#include "report/spectrogram.h"
#include "scene/surfaces.h"
#include "session/simulation.h"
#include "sound/audio/wav.h"
#include "sound/synthesizer.h"
#include "surface/recipes/builtin.h"

namespace intaglio::report {

namespace {

constexpr double ball_radius = 0.01, drop_height = 0.01, rolling_speed = 0.6, scraping_speed = 0.15;

scene::PenSettings scraping_pen() {
  scene::PenSettings pen;
  pen.workspace.scale = 3;
  pen.tip_radius = 0.0005;
  pen.hand.stiffness = 1000;
  pen.hand.damping = 15;
  for (double t = 0; t < 2.05; t += 0.1) {
    const double x = -0.14 + scraping_speed * std::max(0.0, t - 0.3);
    const double y = std::max(-0.012, 0.02 - 0.1 * t);
    pen.path.push_back({t, {x, y, 0.03 - 0.15 * x}});
  }
  return pen;
}

}  // namespace

std::string touch_name(TouchKind touch) {
  return touch == TouchKind::strike ? "strike" : touch == TouchKind::scrape ? "scrape" : "roll";
}

scene::Scene touch_scene(TouchKind touch, const std::string& texture) {
  scene::Scene scene;
  scene.name = scene.title = texture + ", " + touch_name(touch);
  scene.duration = 2;
  scene.surface.texture = texture;
  scene.surface.size = {0.5, 0.5};
  scene.surface.thickness = 0.03;
  scene.sound.modes = 80;
  scene.camera.eye = {0, 0.35, 0.35};
  scene.camera.target = Vec3::Zero();
  scene::BallSettings ball;
  ball.radius = ball_radius;
  ball.material = *find_material(touch == TouchKind::strike ? "wood" : "steel");
  if (touch == TouchKind::strike) {
    ball.position = {0.03, drop_height + ball_radius, 0.04};
    scene.balls.push_back(ball);
  } else if (touch == TouchKind::roll) {
    ball.position = {-0.22, ball_radius + 0.001, 0.12};
    ball.velocity = {rolling_speed, 0, -0.4 * rolling_speed};
    ball.angular_velocity = Vec3::UnitY().cross(ball.velocity) / ball_radius;
    scene.balls.push_back(ball);
  } else {
    scene.pen = scraping_pen();
  }
  return scene;
}

namespace fs = std::filesystem;

namespace {

constexpr int picture_width = 200, picture_height = 90;
constexpr double shown_db = 70;
constexpr float peak_shown = 0.7f;
constexpr double headroom_db = 30;      // keeps the signal below the limiter
constexpr double quiet_pascal = 20e-6;  // 0 dB SPL

struct RenderedSound {
  std::string file;      // without extension
  double peak_db = 0;    // dB SPL at the ears
  double centre_hz = 0;  // mean frequency of its power
};

double peak_of(const std::vector<float>& audio) {
  float peak = 0;
  for (const float x : audio) peak = std::max(peak, std::abs(x));
  return double(peak);
}

Image8 picture(const Spectrogram& spectrogram, double duration) {
  SpectrogramView view;
  view.duration = duration;
  view.low_hz = 60;
  view.high_hz = 18'000;
  const auto loudest = std::max_element(spectrogram.power.begin(), spectrogram.power.end());
  view.top_db = loudest == spectrogram.power.end() ? 0 : level_db(double(*loudest), -200);
  view.floor_db = view.top_db - shown_db;
  return spectrogram_image(spectrogram, view, picture_width, picture_height);
}

// A texture's name on the page and in file names: the last part of a path, without extension.
std::string short_name(const std::string& texture) {
  fs::path path = fs::path(texture).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  const std::string stem = path.stem().string();
  return stem.empty() || stem == "." || stem == ".." ? "texture" : stem;
}

// Every texture can be read, and all have distinct names.
Result<void> check_textures(const std::vector<std::string>& textures) {
  std::map<std::string, std::string> named;
  for (const std::string& texture : textures) {
    const auto [other, is_new] = named.try_emplace(short_name(texture), texture);
    if (!is_new)
      return fail(texture, fmt::format("gives the same output files as {}", other->second),
                  "use each texture once, with distinct names");
    if (const auto surface = scene::make_surface(touch_scene(TouchKind::strike, texture)); !surface)
      return tl::unexpected(surface.error());
  }
  return {};
}

Result<RenderedSound> make_sound(const SoundPageJob& job, const std::string& texture, TouchKind touch,
                                 OutputFiles& files) {
  scene::Scene scene = touch_scene(touch, texture);
  scene.sound.gain_db = -headroom_db;
  auto recording = session::play(scene);
  if (!recording) return tl::unexpected(recording.error());
  std::vector<float>& audio = recording->audio;
  RenderedSound sound{short_name(texture) + "_" + touch_name(touch)};
  const double peak = peak_of(audio);
  if (!(peak > 0)) return fail(texture, "produced silence for " + touch_name(touch));
  sound.peak_db = 20 * std::log10(peak * sound::full_scale_pascal / quiet_pascal) + headroom_db;
  const Spectrogram spectrogram = make_spectrogram(audio, recording->sample_rate, 1024);
  double power = 0;
  const std::vector<double> spectrum = mean_spectrum(spectrogram);
  for (std::size_t bin = 0; bin < spectrum.size(); ++bin) {
    power += spectrum[bin];
    sound.centre_hz += spectrum[bin] * double(bin) * spectrogram.bin_hz();
  }
  sound.centre_hz /= power;
  for (float& x : audio) x *= peak_shown / float(peak);
  const auto path = [&](const char* extension) { return job.folder / (sound.file + extension); };
  if (auto done = files.write(path(".png"), encode_png(picture(spectrogram, recording->duration))); !done)
    return tl::unexpected(done.error());
  if (auto done = sound::add_wav(files, path(".mp3"), audio, recording->sample_rate, {sound::WavFormat::mp3});
      !done)
    return tl::unexpected(done.error());
  return sound;
}

std::string cell(const RenderedSound& sound) {
  return fmt::format(
      "<td><img src=\"{0}.png\" width=\"{1}\" height=\"{2}\" alt=\"spectrogram\"><br>"
      "<audio controls preload=\"none\" src=\"{0}.mp3\"></audio><br>"
      "<small>{3:.0f} dB SPL peak, centre {4:.1f} kHz</small></td>\n",
      url_encoded(sound.file), picture_width, picture_height, sound.peak_db, sound.centre_hz / 1000);
}

constexpr const char* page_start =
    "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Intaglio: how the materials sound</title>\n"
    "<meta name=\"viewport\" content=\"width=device-width\">\n"
    "<style>body{font:15px/1.45 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}"
    "td,th{padding:.5rem;vertical-align:top;text-align:left}audio{width:200px;height:32px}"
    "small{color:#666}img{border-radius:3px}</style></head><body>\n"
    "<h1>How the materials sound</h1>\n"
    "<p>Each built-in texture on a slab of 50 × 50 × 3 cm: a wooden ball of 2 cm falls on it from 1 cm, a wooden pen is "
    "dragged over it at 15 cm/s, and a steel ball of 2 cm rolls over it at 0.6 m/s; heard from half a metre. All of it is "
    "synthesised from the relief, the material and the contacts of the simulation. Playback is normalised; the "
    "true level is printed. Spectrograms: 0 to 2 s, 60 Hz to 18 kHz on a logarithmic axis, 70 dB.</p>\n"
    "<table><tr><th></th><th>struck</th><th>scraped</th><th>rolled on</th></tr>\n";

}  // namespace

Result<void> make_sound_page(const SoundPageJob& job) {
  if (auto writable = check_writable(job.folder / "index.html"); !writable) return writable;
  std::vector<std::string> textures = job.textures;
  if (textures.empty()) textures = surface::builtin_names();
  if (auto checked = check_textures(textures); !checked) return checked;
  Progress progress("sound page", job.quiet);
  std::string html = page_start;
  const double total = double(textures.size() * touch_kinds.size());
  double done = 0;
  OutputFiles files;
  for (const std::string& texture : textures) {
    html += fmt::format("<tr><th>{}</th>\n", escape_html(short_name(texture)));
    for (const TouchKind touch : touch_kinds) {
      progress.update(done++ / total, texture + ", " + touch_name(touch));
      const auto sound = make_sound(job, texture, touch, files);
      if (!sound) return tl::unexpected(sound.error());
      html += cell(*sound);
    }
    html += "</tr>\n";
  }
  html += "</table>\n<p>Made by <code>intaglio sound page -o DIR</code>.</p></body></html>\n";
  if (auto page = files.write(job.folder / "index.html", html); !page) return page;
  if (auto committed = files.commit(); !committed) return committed;
  progress.update(1, "written");
  return {};
}

}  // namespace intaglio::report
