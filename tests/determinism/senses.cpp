#include "tests/determinism/senses.h"

#include <cmath>
#include <span>

#include "contact/curved_contacts.h"
#include "contact/surface_contacts.h"
#include "core/portable_math.h"
#include "dynamics/world.h"
#include "haptics/device.h"
#include "haptics/servo.h"
#include "intaglio/representation.h"
#include "intaglio/vec.h"
#include "sound/synthesizer.h"
#include "tests/determinism/scenes.h"

namespace intaglio::determinism {

namespace {

Outcome elementary_functions() {
  Hash hash;
  Random random(6);
  for (int k = 0; k < 100'000; ++k) {
    const double x = random.uniform(-20, 20), size = std::ldexp(random.uniform(1, 2), k % 200 - 100);
    for (const double value : {elementary::sin(x), elementary::cos(x * size), elementary::exp(x),
                               elementary::log(size), elementary::pow(size, 0.1 * x), elementary::cbrt(size),
                               elementary::atan2(x, size), elementary::acos(0.05 * x), elementary::tanh(x)})
      hash.add(value);
  }
  return {hash.value(), {}};
}

Outcome textures() {
  Outcome out;
  Hash hash;
  for (const char* name : {"brick", "wood_grain", "pebbles", "metal_studs"}) {
    const auto surface = floor(name);
    Random random(1);
    for (int k = 0; k < 2000; ++k) {
      const double u = random.uniform(), v = random.uniform();
      const Vec2 uv(u, v);
      const double footprint = random.uniform(0, 0.1);
      const surface::Smooth smooth = surface->smooth(uv, footprint);
      add(hash, smooth.height);
      add(hash, smooth.gradient);
      add(hash, surface->normal(uv));
      add(hash, surface->depth(uv));
      out.numbers.push_back(smooth.height);
    }
  }
  const surface::Texels fused = imported("brick");
  hash.add(std::span<const float>(fused.depth));
  for (const Vec3& normal : fused.normal) add(hash, normal);
  return {hash.value(), out.numbers};
}

Outcome contacts() {
  Outcome out;
  Hash hash;
  const auto keep = [&](const contact::ContactSet& set) {
    hash.add(set.status);
    for (const contact::ContactPoint& p : set) {
      for (const Vec3& v : {p.point, p.normal, p.n_s}) add(hash, v);
      add(hash, p.uv);
      add(hash, p.distance);
      hash.add(p.feature);
      out.numbers.push_back(p.distance);
    }
  };
  const auto surface = floor("brick");
  const surface::ReliefMesh ball = skin("pebbles", 0.3, false);
  for (const NamedShape& shape : shapes()) {
    Random random(2);
    for (int k = 0; k < 60; ++k) {
      const double x = random.uniform(-0.4, 0.4), y = random.uniform(0, 0.05);
      const Vec3 flat(x, y, random.uniform(-0.4, 0.4));
      const Pose pose{flat, any_turn(random)};
      keep(contact::relief_contacts(*surface, shape.shape, pose, 0.01));
      keep(contact::directional_contacts(*surface, shape.shape, pose, 0.01));
      keep(contact::normal_map_contacts(*surface, shape.shape, pose, 0.01));
      const double away = random.uniform(0.31, 0.36);
      const Pose beside{away * any_vector(random, 1).normalized(), pose.orientation};
      keep(contact::curved_contacts(ball, shape.shape, beside, 0.01));
    }
  }
  return {hash.value(), out.numbers};
}

// A pen that is pressed into the floor, dragged about and lifted.
std::vector<haptics::Waypoint> strokes() {
  Random random(3);
  std::vector<haptics::Waypoint> path = {{0, {0, 0.02, 0}}};
  for (int k = 1; k < 12; ++k) {
    const double x = random.uniform(-0.05, 0.05), y = random.uniform(-0.012, 0.003);
    path.push_back({0.12 * k, {x, y, random.uniform(-0.05, 0.05)}});
  }
  return path;
}

Outcome forces() {
  Outcome out;
  Hash hash;
  const auto surface = floor("brick");
  const auto feel = [&](haptics::PenServo servo, bool moves) {
    haptics::SimulatedDevice device({}, {}, strokes());
    for (int k = 0; k < 1300; ++k) {
      haptics::SceneSnapshot scene;
      const double time = k * 1e-3;
      scene.time = time - k % 10 * 1e-3;
      if (moves) {
        scene.textured.velocity = {0.01, 0, 0.02};
        scene.textured.angular_velocity = {0.1, 0.5, -0.2};
        scene.textured.pose = scene.textured.extrapolated(scene.time);
        scene.balls[0] = {{0.02, 0.01, 0.01}, {-0.02, 0, 0}, 0.015};
        scene.ball_count = 1;
      }
      const haptics::ServoSample s = servo.tick(device, scene, time);
      for (const Vec3& v : {s.device, s.tip, s.velocity, s.proxy, s.force, s.wanted, s.torque, s.n_s})
        add(hash, v);
      add(hash, s.uv);
      add(hash, s.energy_surplus);
      hash.add(s.guard_status);
      for (int c = 0; c < 3; ++c) out.numbers.push_back(s.force[c]);
      device.advance(1e-3);
    }
  };
  for (const Representation representation :
       {Representation::flat, Representation::normal, Representation::relief}) {
    for (const auto method : {haptics::HapticMethod::potential, haptics::HapticMethod::plane}) {
      haptics::ServoOptions options;
      options.representation = representation;
      options.method = method;
      options.workspace.scale = 2.3;
      options.pen.shaft_stiffness = representation == Representation::relief ? 2000 : 0;
      feel(haptics::PenServo(surface, options), method == haptics::HapticMethod::potential);
    }
  }
  return {hash.value(), out.numbers};
}

std::vector<float> heard(const std::shared_ptr<const surface::Surface>& surface, int bodies,
                         const std::vector<ContactEvent>& events, sound::MesoSource meso, double seconds) {
  sound::SynthesizerOptions options;
  options.meso = meso;
  options.max_modes = 320;  // so that some are faded out
  sound::Synthesizer synthesizer(options, sounding(surface, bodies));
  std::vector<float> out(2 * std::size_t(seconds * options.sample_rate));
  for (const ContactEvent& event : events) synthesizer.push(event);
  constexpr std::size_t cut = 2 * 441;
  for (std::size_t k = 0; k < out.size(); k += cut) {
    const double angle = 1e-5 * double(k);
    synthesizer.set_listener({{elementary::cos(angle), 0.5, elementary::sin(angle)}, Vec3::UnitX()});
    synthesizer.render_stereo(std::span(out).subspan(k, std::min(cut, out.size() - k)));
  }
  return out;
}

void keep(Outcome& out, Hash& hash, std::vector<float> samples) {
  hash.add(std::span<const float>(samples));
  for (const float x : samples) out.numbers.push_back(double(x));
  // Loud, so that the limiter has something to do.
  sound::to_full_scale(samples, samples, {20});
  hash.add(std::span<const float>(samples));
}

// Made-up events of bodies that land, scrape and roll.
std::vector<ContactEvent> made_up_events(int bodies) {
  std::vector<ContactEvent> events;
  Random random(4);
  for (int k = 1; k < 700; ++k) {
    for (int b = 1; b <= bodies; ++b) {
      const int beat = (k + 37 * b) % 150;
      if (beat > 110) continue;
      ContactEvent e;
      e.time = k / 480.0;
      e.duration = 1.0 / 480;
      e.body = static_cast<BodyId>(b);
      e.phase = beat == 0 ? ContactPhase::begin : beat == 110 ? ContactPhase::end : ContactPhase::persist;
      e.v_t = {0.3 * b, 0, -0.2};
      const double u = 0.1 + 0.3 * b * e.time, v = 0.4 + 0.2 * e.time;
      e.uv = {u - std::floor(u), v - std::floor(v)};
      e.point = {e.uv.x() - 0.5, 0, 0.5 - e.uv.y()};
      const double tilt = random.uniform(-0.3, 0.3);
      e.n_s = Vec3(tilt, 1, random.uniform(-0.3, 0.3)).normalized();
      if (e.phase != ContactPhase::end) e.impulse = (beat == 0 ? 0.05 : random.uniform(0.005, 0.015)) * e.n_s;
      if (beat == 0) e.touch_age = random.uniform(0, e.duration);
      e.body_pose = {e.point + Vec3(0, 0.05, 0), rotation(Vec3(0, 0, -6.0 * e.time))};
      events.push_back(e);
    }
  }
  return events;
}

Outcome audio() {
  Outcome out;
  Hash hash;
  const auto surface = floor("brick");
  const std::vector<ContactEvent> events = made_up_events(4);
  for (const auto meso :
       {sound::MesoSource::engine_impulses, sound::MesoSource::normal_map, sound::MesoSource::height})
    keep(out, hash, heard(surface, 4, events, meso, 1.5));
  return {hash.value(), out.numbers};
}

std::vector<ContactEvent> events_of(dynamics::World& world, double seconds,
                                    const std::function<void(int)>& before = {}) {
  std::vector<ContactEvent> out;
  for (int k = 0; k < int(480 * seconds); ++k) {
    if (before) before(k);
    world.step();
    out.insert(out.end(), world.events().begin(), world.events().end());
  }
  return out;
}

Material material() {
  Material out = *find_material("stone");
  out.restitution = 0.5;
  return out;
}

constexpr int tumbling = 10;

void throw_in(dynamics::World& world, int count, double spread) {
  Random random(5);
  const std::vector<NamedShape> all = shapes();
  for (int k = 0; k < count; ++k) {
    dynamics::ShapeBody body;
    body.shape = all[std::size_t(k) % all.size()].shape;
    body.material = material();
    body.pose = {{random.uniform(-spread, spread), 0.1 + 0.06 * k, random.uniform(-spread, spread)},
                 any_turn(random)};
    body.velocity = any_vector(random, 0.8);
    body.angular_velocity = any_vector(random, 6);
    world.add(body);
  }
}

std::vector<ContactEvent> tumble(const std::shared_ptr<const surface::Surface>& surface,
                                 Representation representation) {
  dynamics::WorldOptions options;
  options.representation = representation;
  dynamics::World world(surface, material(), options);
  throw_in(world, tumbling, 0.3);
  return events_of(world, 1.5);
}

void keep(Outcome& out, Hash& hash, const std::vector<ContactEvent>& events) {
  for (const ContactEvent& event : events) {
    add(hash, event);
    for (const Vec3& v : {event.point, event.impulse})
      for (int c = 0; c < 3; ++c) out.numbers.push_back(v[c]);
  }
}

Outcome events() {
  Outcome out;
  Hash hash;
  const auto surface = floor("brick");
  keep(out, hash, tumble(surface, Representation::relief));
  keep(out, hash, tumble(surface, Representation::normal));
  // Balls in a bowl, and a paddle that is driven faster than a texel a step.
  dynamics::World bowl(skin("pebbles", 0.6, true), material(), {});
  Random random(7);
  for (int k = 0; k < 4; ++k) {
    dynamics::SphereBody ball;
    ball.radius = 0.04;
    ball.material = material();
    ball.position = {0.12 * k - 0.2, -0.3, random.uniform(-0.1, 0.1)};
    ball.velocity = any_vector(random, 0.5);
    bowl.add(ball);
  }
  dynamics::ShapeBody paddle;
  paddle.shape = contact::Box{{0.15, 0.02, 0.05}};
  paddle.material = material();
  paddle.motion = dynamics::Motion::driven;
  paddle.pose.position = {0, -0.45, 0};
  const BodyId driven = bowl.add(paddle);
  keep(out, hash, events_of(bowl, 0.7, [&](int k) {
         bowl.drive(driven, {paddle.pose.position, rotation(0.05 * k, Vec3::UnitY())});
       }));
  return {hash.value(), out.numbers};
}

Outcome heard_of_bullet() {
  Outcome out;
  Hash hash;
  const auto surface = floor("brick");
  keep(out, hash,
       heard(surface, tumbling, tumble(surface, Representation::relief), sound::MesoSource::height, 1.5));
  return {hash.value(), out.numbers};
}

}  // namespace

std::vector<Sense> senses() {
  return {{"elementary", "sines, exponentials and roots of core/elementary.h", elementary_functions},
          {"texture", "built-in materials, a fused import, the surface sampled", textures},
          {"contact", "five shapes against reliefs, flat and curved", contacts},
          {"force", "a pen's servo: both methods, three representations", forces},
          {"audio", "struck and scraped modal models, three kinds of meso", audio},
          {"event", "bodies in Bullet on a floor and in a bowl", events, true},
          {"heard", "the sound of such a floor", heard_of_bullet, true}};
}

}  // namespace intaglio::determinism
