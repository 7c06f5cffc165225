// Is every bump heard when it is felt and where it is seen? A pen is dragged and a ball rolls over a grating;
// bodies are damped so that each crossing is one short click.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "intaglio/representation.h"
#include "session/simulation.h"
#include "tests/sampling.h"
#include "tests/session/sessions.h"

using namespace intaglio;
using namespace intaglio::scene;
using namespace intaglio::session;

namespace {

constexpr double rate = 44'100;
constexpr double tau = 2 * std::numbers::pi;
constexpr double side = 0.5;  // m

// Ridges and grooves of equal width across X, `wavelength` apart; edges are two texels wide.
SceneSurface grating(double wavelength, double depth) {
  constexpr int size = 2000;
  surface::Texels texels;
  texels.width = size;
  texels.height = 4;
  std::vector<float> row;
  for (int i = 0; i < size; ++i) {
    const double x = (i + 0.5) * side / size, phase = x / wavelength - std::floor(x / wavelength);
    row.push_back(phase < 0.5 ? 0.0f : 1.0f);
  }
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < size; ++i) {
      const auto at = [&](int k) { return double(row[std::size_t((k + size) % size)]); };
      texels.depth.push_back(row[std::size_t(i)]);
      const double slope = -depth * (at(i + 1) - at(i - 1)) / (2 * side / size);
      texels.normal.push_back(Vec3(-slope, 0, 1).normalized());
    }
  }
  SceneSurface out;
  out.surface = std::make_shared<const surface::Surface>(
      std::move(texels), surface::Placement(Vec3::Zero(), Quat::Identity(), side, side), depth,
      surface::Edge::wrap);
  out.material = *find_material("brick");
  out.material.rayleigh_alpha = 2000;
  return out;
}

Recording run(const Scene& scene, const SceneSurface& surface) {
  auto recording = play(scene, surface, tests::cached_models());
  REQUIRE(recording);
  return std::move(*recording);
}

Scene scene_of(const std::string& text) {
  auto scene = parse_scene(text + "[surface]\nsize = [0.5, 0.5]\n[sound]\nmodes = 40\nmicro = 0\n", "g.toml");
  REQUIRE_MESSAGE(scene, (scene ? "" : scene.error().message()));
  return *scene;
}

// Over what way the sound repeats, near `wavelength`, of what goes through x(t) from `from` to `to` s: where
// the energy of its envelope's harmonics over the way is greatest. At constant speed v the pitch is v over
// it.
template <class Position>
double repetition(const std::vector<float>& audio, double from, double to, double wavelength,
                  const Position& x) {
  const auto a = std::size_t(from * rate), b = std::size_t(to * rate);
  std::vector<std::array<double, 2>> way;  // x, power
  for (std::size_t k = a; k < b; ++k) {
    const double window = 0.5 - 0.5 * std::cos(tau * double(k - a) / double(b - a));
    way.push_back({x(double(k) / rate), window * double(audio[k]) * double(audio[k])});
  }
  double best = 0, best_length = 0;
  for (double length = 0.97 * wavelength; length <= 1.03 * wavelength; length += 0.001 * wavelength) {
    double sum = 0;
    for (int harmonic = 1; harmonic <= 3; ++harmonic) {
      double re = 0, im = 0;
      for (const auto& [at, power] : way) {
        re += power * std::cos(tau * harmonic * at / length);
        im += power * std::sin(tau * harmonic * at / length);
      }
      sum += re * re + im * im;
    }
    if (sum > best) {
      best = sum;
      best_length = length;
    }
  }
  return best_length;
}

// x of a series of values `rate_hz` a second, between them linear.
template <class Value>
double between(double time, double rate_hz, const Value& value) {
  const auto k = std::size_t(time * rate_hz);
  const double t = time * rate_hz - double(k);
  return (1 - t) * value(k) + t * value(k + 1);
}

// When a click begins: the first sample of at least a fifth of the most that follows within 5 ms, after 5 ms
// that had less than half of it.
std::vector<double> onsets(const std::vector<float>& audio, double from, double to, float least) {
  std::vector<double> times;
  const auto reach = std::ptrdiff_t(0.005 * rate);
  const auto most = [&](std::ptrdiff_t a, std::ptrdiff_t b) {
    float m = 0;
    for (auto k = std::max<std::ptrdiff_t>(a, 1); k < b; ++k)
      m = std::max(m, std::abs(audio[std::size_t(k)] - audio[std::size_t(k - 1)]));
    return m;
  };
  for (auto k = std::ptrdiff_t(from * rate); k < std::ptrdiff_t(to * rate); ++k) {
    const float ahead = most(k, k + reach);
    if (ahead < least || most(k, k + 1) < 0.2f * ahead || most(k - reach, k) > 0.5f * ahead) continue;
    times.push_back(double(k) / rate);
    k += reach;
  }
  return times;
}

// When a click that begins then is strongest: the greatest step within 5 ms.
double peak_of(const std::vector<float>& audio, double onset) {
  const auto step = [&](std::size_t k) { return std::abs(audio[k] - audio[k - 1]); };
  const auto first = std::size_t(onset * rate + 0.5);
  std::size_t best = first;
  for (std::size_t k = first; k < first + std::size_t(0.005 * rate); ++k) {
    if (step(k) > step(best)) best = k;
  }
  return double(best) / rate;
}

// How far `time` is from the nearest of `ticks`, each of which lasts a tick.
double distance(const std::vector<double>& ticks, double time, double tick) {
  double best = 1e9;
  for (const double t : ticks) best = std::min(best, std::max({0.0, t - time, time - t - tick}));
  return best;
}

double loudest(const std::vector<float>& audio) {
  float most = 0;
  for (std::size_t k = 1; k < audio.size(); ++k) most = std::max(most, std::abs(audio[k] - audio[k - 1]));
  return double(most);
}

// The servo's ticks at which the force changes most.
std::vector<double> force_peaks(const Recording& r) {
  const auto change = [&](std::size_t k) { return (r.servo[k].force - r.servo[k - 1].force).norm(); };
  std::vector<double> times;
  for (std::size_t k = 2; k + 1 < r.servo.size(); ++k) {
    if (change(k) > 0.02 && change(k) >= change(k - 1) && change(k) > change(k + 1))
      times.push_back(double(k) / r.servo_rate);
  }
  return times;
}

// The ticks at which the tip is on an edge of the picture, within the texels between which it falls, or
// passes one.
std::vector<double> edge_times(const Recording& r, double wavelength) {
  std::vector<double> times;
  const double near = 1.5 * r.surface->texel_u();
  for (std::size_t k = 1; k < r.servo.size(); ++k) {
    const double x = r.servo[k].uv.x() * side, before = r.servo[k - 1].uv.x() * side;
    const auto edge = [&](double at) { return std::round(2 * at / wavelength) * wavelength / 2; };
    const bool passes = std::floor(2 * x / wavelength) != std::floor(2 * before / wavelength);
    if (passes || std::abs(x - edge(x)) < near || std::abs(before - edge(before)) < near)
      times.push_back(double(k) / r.servo_rate);
  }
  return times;
}

}  // namespace

TEST_CASE(
    "a pen dragged over a grating sounds at v / lambda, each click begins at an edge, and peaks when the force does") {
  const double wavelength = 0.01, speed = 0.12;
  Scene scene = scene_of(
      "duration = 4\n[pen]\nworkspace_scale = 3\ntip_radius = 0.0001\nhand_stiffness = 2000\n"
      "hand_damping = 20\npath = [[0, 0, 0, 0]]\n");
  scene.pen->material.rayleigh_alpha = 2000;
  scene.pen->path.clear();
  for (double t = 0; t < 4.1; t += 0.1)
    scene.pen->path.push_back(
        {t, {-0.22 + speed * std::max(0.0, t - 0.6), std::max(-0.001, 0.01 - 0.02 * t), 0}});
  const Recording recording = run(scene, grating(wavelength, 0.0004));
  const auto tip = [&](double t) {
    return between(t, recording.servo_rate, [&](std::size_t k) { return recording.servo[k].tip.x(); });
  };
  const double from = 1.2, to = 3.9;
  const double hertz = (tip(to) - tip(from)) / (to - from) / wavelength;
  CHECK(hertz == doctest::Approx(speed / wavelength).epsilon(0.02));
  const double heard = repetition(recording.audio, from, to, wavelength, tip);
  CHECK(heard == doctest::Approx(wavelength).epsilon(0.005));
  const std::vector<double> peaks = force_peaks(recording), edges = edge_times(recording, wavelength);
  const std::vector<double> clicks = onsets(recording.audio, from, to, float(0.1 * loudest(recording.audio)));
  const double tick = 1.0 / recording.servo_rate;
  double worst_peak = 0, worst_edge = 0;
  for (const double t : clicks) {
    worst_peak = std::max(worst_peak, distance(peaks, peak_of(recording.audio, t), tick));
    worst_edge = std::max(worst_edge, distance(edges, t, tick));
  }
  MESSAGE("v / lambda " << hertz << " Hz, heard " << hertz * wavelength / heard << " Hz; " << clicks.size()
                        << " onsets at " << 2 * hertz * (to - from)
                        << " edges, their peaks from a force peak at most " << 1000 * worst_peak
                        << " ms, their begins from an edge " << 1000 * worst_edge << " ms");
  CHECK(double(clicks.size()) > 1.8 * hertz * (to - from));
  CHECK(worst_peak < 1e-3);
  CHECK(worst_edge < 1e-3);
}

TEST_CASE("a ball that rolls over a grating sounds at v / lambda, whichever source its relief sounds from" *
          doctest::test_suite("statistics")) {
  const double wavelength = 0.01;
  for (const char* kind : {"representation = \"normal\"", "meso = \"engine\"", "meso = \"height\""}) {
    CAPTURE(kind);
    const bool is_normal = std::string(kind).starts_with("rep");
    Scene scene = scene_of(
        "duration = 1.7\n[[ball]]\nradius = 0.02\nposition = [-0.23, 0.0201, 0]\nvelocity = "
        "[0.3, 0, 0]\nspin = [0, 0, -15]\n");
    if (is_normal) scene.surface.representation = Representation::normal;
    if (!is_normal)
      scene.sound.meso = std::string(kind).find("height") != std::string::npos
                             ? sound::MesoSource::height
                             : sound::MesoSource::engine_impulses;
    scene.physics.rate = 960;
    scene.balls[0].material.rayleigh_alpha = 2000;
    scene.balls[0].material.rolling_resistance = 0;
    SceneSurface surface = grating(wavelength, 0.00005);
    surface.material.rolling_resistance = 0;
    const Recording recording = run(scene, surface);
    const double from = 0.2, to = 1.5;
    const auto x = [&](double t) {
      return between(t, 960, [&](std::size_t k) { return recording.tracks[0][k - 1].x(); });
    };
    const double hertz = (x(to) - x(from)) / (to - from) / wavelength;
    const double heard = repetition(recording.audio, from, to, wavelength, x);
    MESSAGE(std::string(kind) << ": v / lambda " << hertz << " Hz, heard " << hertz * wavelength / heard
                              << " Hz");
    CHECK(hertz > 20);
    CHECK(heard == doctest::Approx(wavelength).epsilon(0.005));
  }
}

TEST_CASE("a ball with a grating round it sounds at v / lambda on a flat floor: its own texture is swept" *
          doctest::test_suite("statistics")) {
  constexpr int waves = 12;
  constexpr double radius = 0.02, wavelength = tau * radius / waves;
  for (const char* source : {"texels", "height", "engine", "height on relief"}) {
    if (tests::is_sampled() && std::string(source) != "engine") continue;
    CAPTURE(source);
    const std::string kind = source;
    const bool is_relief = kind == "engine" || kind == "height on relief";
    const double depth = is_relief ? 0.0003 : 0.00005;
    // Its poles are to either side of its way.
    Scene scene = scene_of(
        "duration = 1.7\n[[body]]\nshape = \"sphere\"\nradius = 0.02\nposition = [-0.23, 0.02001, 0]\n"
        "rotation = [90, 0, 0]\nvelocity = [0.3, 0, 0]\nspin = [0, 0, -15]\n"
        "skin = { texture = \"brick_running\", depth = 0.00005 }\n");
    scene.surface.representation = is_relief ? Representation::relief : Representation::normal;
    scene.sound.meso = kind == "engine"             ? sound::MesoSource::engine_impulses
                       : kind.starts_with("height") ? sound::MesoSource::height
                                                    : sound::MesoSource::normal_map;
    scene.physics.rate = 960;
    SceneSurface surface = grating(1, 0);
    auto made = make_surface(scene);
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message()));
    surface.reliefs = std::move(made->reliefs);
    SceneSurface& skin = surface.reliefs[0][0];
    skin.surface = grating(side / waves, depth).surface;
    skin.curved = *surface::ReliefMesh::make(skin.surface, skin.curved->base());
    for (Material* material : {&scene.bodies[0].body.material, &surface.material}) {
      material->rayleigh_alpha = 2000;
      material->rolling_resistance = 0;
    }
    const Recording recording = run(scene, surface);
    std::vector<Vec2> way;  // s, m over its own texture
    double u = 0, travelled = 0;
    for (const ContactEvent& e : recording.events) {
      if (!e.own || (!way.empty() && e.time <= way.back().x())) continue;
      const double turned = e.own->uv.x() - u;
      if (!way.empty()) travelled += (turned - std::round(turned)) * tau * radius;
      u = e.own->uv.x();
      way.emplace_back(e.time, std::abs(travelled));
    }
    REQUIRE(way.size() > 1000);
    const auto x = [&](double t) {
      const auto next = std::upper_bound(way.begin(), way.end() - 1, t,
                                         [](double at, const Vec2& w) { return at < w.x(); });
      const Vec2 &b = *next, &a = *std::max(way.begin(), next - 1);
      return b.x() > a.x() ? a.y() + (b.y() - a.y()) * (t - a.x()) / (b.x() - a.x()) : a.y();
    };
    const double from = 0.2, to = 1.5, hertz = (x(to) - x(from)) / (to - from) / wavelength;
    const double heard = repetition(recording.audio, from, to, wavelength, x);
    MESSAGE(std::string(source) << ": v / lambda " << hertz << " Hz, heard " << hertz * wavelength / heard
                                << " Hz");
    CHECK(hertz > 10);
    CHECK(heard == doctest::Approx(wavelength).epsilon(0.005));
    CHECK(loudest(recording.audio) > 0);
  }
}

TEST_CASE("each onset of a ball that rolls over a relief is at a touch, as early within its step") {
  const double wavelength = 0.02;
  Scene scene = scene_of(
      "duration = 1.4\n[[ball]]\nradius = 0.02\nposition = [-0.2, 0.0201, 0.01]\nvelocity = [0.3, 0, 0]\n"
      "spin = [0, 0, -15]\n");
  SceneSurface surface = grating(wavelength, 0.0002);
  scene.balls[0].material.rayleigh_alpha = 2000;
  for (Material* material : {&scene.balls[0].material, &surface.material}) {
    material->rolling_resistance = 0;
    material->restitution = 0;
  }
  CHECK(scene.physics.rate == 480);
  const Recording recording = run(scene, surface);
  double most = 0;
  for (const ContactEvent& e : recording.events) most = std::max(most, e.impulse.norm());
  std::vector<double> touches, edges;  // those at an edge of the picture; the others land on its flats
  // Steps in which a lasting contact takes up more load, as when hops end: no touch, but heard within the
  // step.
  std::vector<double> loads;
  double before = 0;
  for (const ContactEvent& e : recording.events) {
    const double rise = e.impulse.norm() - std::exchange(before, e.impulse.norm());
    if (std::isnan(e.touch_age) && rise > 0.05 * most) loads.push_back(e.time - e.duration);
    if (std::isnan(e.touch_age) || e.impulse.norm() < 0.05 * most) continue;
    const double x = e.uv.x() * side, edge = std::round(2 * x / wavelength) * wavelength / 2;
    touches.push_back(e.time - e.touch_age);
    if (std::abs(x - edge) < 2 * recording.surface->texel_u()) edges.push_back(touches.back());
  }
  const std::vector<double> clicks = onsets(recording.audio, 0.1, 1.3, float(0.1 * loudest(recording.audio)));
  double worst = 0;
  std::size_t at_edges = 0, of_loads = 0;
  for (const double t : clicks) {
    const double of_touch = distance(touches, t, 0), of_load = distance(loads, t, 1 / 480.0);
    of_loads += of_load < of_touch;
    worst = std::max(worst, std::min(of_touch, of_load));
    at_edges += distance(edges, t, 0) < 1e-3;
  }
  MESSAGE(clicks.size() << " onsets, at most " << 1000 * worst << " ms from one of " << touches.size()
                        << " touches, of which " << at_edges << " are at edges of the picture; " << of_loads
                        << " of more load");
  CHECK(of_loads <= clicks.size() / 10);
  CHECK(at_edges > clicks.size() / 4);
  CHECK(clicks.size() > 10);
  CHECK(worst < 1e-3);
}
