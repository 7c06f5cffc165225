// Things that happen, for tests of sound: a plastic ball on a brick slab, and what a physics engine reports.
#pragma once

#include <vector>

#include "core/portable_math.h"
#include "intaglio/event.h"
#include "sound/synthesizer.h"
#include "tests/sound/models.h"

namespace intaglio::sound::test {

inline constexpr double step = 1.0 / 480;
inline constexpr BodyId ball_id = 7;

inline std::shared_ptr<const surface::Surface> grooves(double slope) {
  surface::Texels texels;
  texels.width = texels.height = 128;
  for (int j = 0; j < 128; ++j) {
    for (int i = 0; i < 128; ++i) texels.normal.push_back(Vec3(slope * std::sin(0.8 * i), 0, 1).normalized());
  }
  return std::make_shared<surface::Surface>(std::move(texels),
                                            surface::Placement(Vec3::Zero(), Quat::Identity(), 0.5, 0.5),
                                            0.001, surface::Edge::wrap);
}

inline std::vector<SoundBody> bodies(double slope = 0.3) {
  SoundBody floor;
  floor.id = floor_body;
  floor.model = test::small_slab();
  floor.is_fixed = true;
  floor.rest_pose.position = {0, -0.015, 0};
  floor.textures = {grooves(slope)};
  SoundBody ball;
  ball.id = ball_id;
  ball.model = test::small_ball();
  ball.mass = ball.model->mass;
  ball.radius_of_curvature = 0.02;
  return {floor, ball};
}

// Step k of a ball that slides along x with `speed`: its impulse is `impulse`, upward.
inline ContactEvent contact(int k, double impulse, double speed = 0,
                            ContactPhase phase = ContactPhase::persist) {
  ContactEvent event;
  event.time = k * step;
  event.duration = step;
  event.body = ball_id;
  event.phase = phase;
  event.uv = {std::fmod(0.1 + speed * event.time / 0.5, 1.0), 0.4};
  event.point = {0.5 * (event.uv.x() - 0.5), 0, 0.05};
  event.v_t = {speed, 0, 0};
  event.impulse = {0, impulse, 0};
  event.body_pose.position = event.point + Vec3(0, 0.02, 0);
  return event;
}

// A tumble: a landing, a rough slide, a lift-off, a bounce.
inline std::vector<ContactEvent> tumble(double loudness = 1) {
  std::vector<ContactEvent> events;
  Random random(11);
  for (int k = 1; k < 200; ++k) {
    const ContactPhase phase = k == 1 ? ContactPhase::begin : ContactPhase::persist;
    events.push_back(contact(k, loudness * (k == 1 ? 0.05 : 0.001 * (1 + random.uniform())), 0.4, phase));
    if (k % 5 == 0) events.push_back(contact(k, loudness * 0.0005, 0.4));  // a second point of the same step
  }
  events.push_back(contact(230, loudness * 0.02, 0, ContactPhase::begin));
  return events;
}

}  // namespace intaglio::sound::test
