// The number of bodies: contact, sound, picture, and whole sessions.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "bench/floors.h"
#include "bench/scaling/law.h"
#include "bench/timing.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "scene/surfaces.h"
#include "session/observer.h"
#include "session/simulation.h"
#include "sound/synthesizer.h"
#include "tests/sound/models.h"
#include "tests/sound/scenes.h"
#include "tests/temporary_folder.h"

namespace intaglio::bench {

namespace {

constexpr double ball_radius = 0.1;  // m

// Rolling balls, each for itself.
Law contact_law(const std::vector<double>& n, int rounds) {
  struct Crowd {
    Crowd(Floor& floor, int count) : world(floor) {
      for (int k = 0; k < count; ++k) world.add(ball);
    }
    btSphereShape ball{btScalar(ball_radius)};
    FloorWorld world;
  };
  const SharedSurface s = bricks(512);
  Floor floor = textured("", s, {});
  std::vector<std::unique_ptr<Crowd>> crowds;
  for (const double count : n) crowds.push_back(std::make_unique<Crowd>(floor, int(count)));
  return {"bodies",
          "contact",
          "us a step, 60 Hz",
          n,
          interleaved(n.size(), rounds,
                      [&](std::size_t k) {
                        std::vector<double> us;
                        roll_balls(crowds[k]->world, floor, ball_radius, 77, us);
                        return summary(us).median;
                      }),
          1e6 / 60,
          "1/60 s"};
}

// Balls that all slide over the grooved slab at once, 480 contacts a second each. A ball has 30 modes.
class Slides {
 public:
  explicit Slides(int count) : count_(count), synthesizer_(options(count), bodies(count)) {}

  // us of events and sound, of each block of 64 samples.
  double block_us(int steps) {
    double samples = 0;
    const double start = cpu_seconds();
    for (int n = 0; n < steps; ++n) {
      ++step_;
      for (int k = 0; k < count_; ++k) {
        ContactEvent event = sound::test::contact(step_, 0.001 * (1 + random_.uniform()), 0.4,
                                                  step_ == 1 ? ContactPhase::begin : ContactPhase::persist);
        event.body = BodyId(1 + k);
        synthesizer_.push(event);
      }
      const auto due = std::size_t(std::floor(step_ * 44'100.0 / 480)) - rendered_;
      block_.resize(2 * due);
      synthesizer_.render_stereo(block_);
      rendered_ += due;
      samples += double(due);
    }
    return 1e6 * (cpu_seconds() - start) * 64 / samples;
  }

 private:
  static sound::SynthesizerOptions options(int count) {
    sound::SynthesizerOptions out;
    out.max_pairs = count;
    out.max_pulses = 16 * count;
    out.max_modes = 1'000'000;
    return out;
  }
  static std::vector<sound::SoundBody> bodies(int count) {
    const std::vector<sound::SoundBody> two = sound::test::bodies();
    std::vector<sound::SoundBody> out = {two[0]};
    for (int k = 0; k < count; ++k) {
      out.push_back(two[1]);
      out.back().id = BodyId(1 + k);
    }
    return out;
  }

  int count_, step_ = 0;
  std::size_t rendered_ = 0;
  Random random_{4};
  sound::Synthesizer synthesizer_;
  std::vector<float> block_;
};

Law sound_law(const std::vector<double>& n, int rounds) {
  std::vector<std::unique_ptr<Slides>> all;
  for (const double count : n) all.push_back(std::make_unique<Slides>(int(count)));
  for (const auto& slides : all) slides->block_us(4);
  return {"bodies",
          "sound",
          "us a block of 64 samples, all sliding",
          n,
          interleaved(n.size(), rounds, [&](std::size_t k) { return all[k]->block_us(8); }),
          64e6 / 44'100,
          "64 samples"};
}

Result<Law> picture_law(const std::vector<double>& n, int rounds) {
  render::RendererOptions options;
  options.width = 320;
  options.height = 180;
  options.supersample = 1;
  auto renderer = render::Renderer::create(*bricks(512), options);
  if (!renderer) return tl::unexpected(renderer.error());
  return Law{"bodies",
             "picture",
             "ms a frame of 320 x 180",
             n,
             interleaved(n.size(), rounds,
                         [&](std::size_t k) {
                           render::FrameScene scene;
                           scene.camera.eye = Vec3(0.2, 1.9, 2.5);
                           Random random(9);
                           for (int ball = 0; ball < int(n[k]); ++ball) {
                             const double x = random.uniform(-1.8, 1.8);
                             const double z = random.uniform(-1.8, 1.8);
                             scene.balls.push_back({{Vec3(x, 0.03, z), Quat::Identity()}, 0.03});
                           }
                           const double start = process_seconds();
                           (*renderer)->draw(scene);
                           return 1e3 * (process_seconds() - start);
                         }),
             1e3 / 30,
             "1/30 s"};
}

// A scene of so many balls that roll over the brick and hit each other, a pen that is dragged, and all of
// their sound: physics at 480 Hz, servo at 1 kHz, 44.1 kHz.
std::string scene_of(int balls, double seconds) {
  std::string text = fmt::format(
      "duration = {}\n[surface]\ndepth = 0.08\nsize = [4, 4]\n[pen]\nworkspace_scale = 20\npath = [[0, -1, -0.05, 0], "
      "[{}, 1, -0.05, 0.3]]\n",
      seconds, seconds);
  const int across = int(std::ceil(std::sqrt(balls)));
  for (int k = 0; k < balls; ++k) {
    const double step = 3.2 / across;
    text += fmt::format(
        "[[ball]]\nradius = 0.03\nposition = [{:.3f}, 0.03, {:.3f}]\nvelocity = [{:.2f}, 0, {:.2f}]\n",
        -1.6 + (k % across + 0.5) * step, -1.6 + (k / across + 0.5) * step, 1.2 * std::cos(k),
        1.2 * std::sin(k));
  }
  return text;
}

struct SessionCost {
  double contacts = 0;              // a step, of balls and pen
  std::array<double, 4> seconds{};  // CPU, a simulated second: of all, contact, sound, touch
};

Result<SessionCost> session_cost(int balls, double seconds, const std::filesystem::path& cache) {
  struct Counter : session::Observer {
    void on_event(const ContactEvent&) override { ++events; }
    double events = 0;
  };
  const auto scene = scene::parse_scene(scene_of(balls, seconds), "bench_scaling");
  if (!scene) return tl::unexpected(scene.error());
  const auto surface = scene::make_surface(*scene);
  if (!surface) return tl::unexpected(surface.error());
  auto simulation = session::Simulation::create(*scene, *surface, {.cache = cache});
  if (!simulation) return tl::unexpected(simulation.error());
  Counter counter;
  (*simulation)->add_observer(counter);
  const double start = cpu_seconds();
  (*simulation)->finish();
  SessionCost out;
  out.seconds[0] = (cpu_seconds() - start) / seconds;
  out.contacts = counter.events / seconds / (*simulation)->run().physics_rate;
  for (const session::SenseCost& cost : (*simulation)->run().costs) {
    const std::size_t sense = cost.sense == "dynamics"  ? 1
                              : cost.sense == "sound"   ? 2
                              : cost.sense == "haptics" ? 3
                                                        : 0;
    if (sense > 0) out.seconds[sense] = cost.total_s / seconds;
  }
  return out;
}

// The cost of a session follows its contacts, which do not follow its balls: some rest, others touch several
// edges.
Result<std::vector<Law>> session_laws(const std::vector<double>& balls, double seconds, int rounds) {
  const tests::TemporaryFolder cache;  // all rounds share these modal models
  std::vector<double> contacts(balls.size());
  std::array<std::vector<std::vector<double>>, 4> all;
  for (auto& sense : all) sense.resize(balls.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < balls.size(); ++k) {
      const auto cost = session_cost(int(balls[k]), seconds, cache.path);
      if (!cost) return tl::unexpected(cost.error());
      contacts[k] = cost->contacts;
      for (std::size_t sense = 0; sense < all.size(); ++sense) all[sense][k].push_back(cost->seconds[sense]);
    }
  }
  std::vector<Law> laws = {{"balls of a session", "contacts", "at once", balls, contacts, 0, ""}};
  const std::array<const char*, 4> senses = {"whole session", "contact", "sound", "touch"};
  for (std::size_t sense = 0; sense < all.size(); ++sense) {
    laws.push_back(
        {"contacts of a session", senses[sense], "CPU-s a simulated second", contacts, {}, 1, "one core"});
    for (const auto& values : all[sense]) laws.back().costs.push_back(summary(values).median);
  }
  return laws;
}

}  // namespace

Result<std::vector<Law>> scale_bodies(const Effort& effort) {
  const int rounds = effort.quick ? 1 : 5;
  const std::vector<double> many = effort.quick
                                       ? std::vector<double>{1, 10, 100, 1000}
                                       : std::vector<double>{1, 3, 10, 30, 100, 300, 1000, 2000, 5000};
  std::vector<Law> laws;
  laws.push_back(contact_law(many, rounds));
  laws.push_back(sound_law(
      effort.quick ? std::vector<double>{1, 10, 100} : std::vector<double>{1, 3, 10, 30, 100, 300, 1000},
      rounds));
  auto picture = picture_law(many, rounds);
  if (!picture) return tl::unexpected(picture.error());
  laws.push_back(*picture);
  auto sessions = session_laws(
      effort.quick ? std::vector<double>{1, 10, 30} : std::vector<double>{1, 3, 10, 30, 60, 100, 200},
      effort.quick ? 0.5 : 2.0, effort.quick ? 1 : 3);
  if (!sessions) return tl::unexpected(sessions.error());
  laws.insert(laws.end(), sessions->begin(), sessions->end());
  return laws;
}

}  // namespace intaglio::bench
