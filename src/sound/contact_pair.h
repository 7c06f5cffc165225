// One pair of bodies in contact: the points of one step, what lasts from step to step, and how both become
// blows and noise.
//
// Internal to sound/. SI units, world frame. One thread; after construction nothing here allocates, locks or
// throws.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/portable_math.h"
#include "intaglio/event.h"
#include "sound/contact_step.h"
#include "sound/ensemble.h"
#include "sound/rubbing.h"
#include "sound/synthesizer.h"

namespace intaglio::sound {

class ContactPair {
 public:
  // A place for a pair; meet() makes it one.
  ContactPair(Ensemble& ensemble, const SynthesizerOptions& options);

  // From now on the place is of these two: indices of the ensemble's bodies.
  void meet(int body, int other);

  int body() const { return sides_[0].body; }
  int other() const { return sides_[1].body; }
  bool is_touching() const { return is_touching_ || step_.duration > 0; }
  // Of the last step, s; before the first none.
  double last_time() const { return last_step_.time; }

  // Takes one more event of the step being gathered. When it belongs to a later step, that one is finished
  // first.
  void add(const ContactEvent& event, double now);
  // Turns the gathered step into sound that begins no earlier than `now`.
  void finish_step(double now);
  // The contact has ended: what lasted is released.
  void part(double now);
  // Hands what lasts in the samples from `first` on to the ensemble.
  void drive(std::int64_t first, std::size_t samples);

  std::uint64_t truncated_paths() const { return truncated_paths_; }

 private:
  // One of the two bodies: `body` feels the impulses as they are reported, `other` their opposite.
  struct Side {
    int body = -1;
    double sign = 1;
    std::vector<float> blow_room, normal_room;      // for the body with most modes
    std::span<float> blow_gains{}, normal_gains{};  // of this one
    // The way of the contact over its texture through the step, if it has one there and a way leads on.
    Vec2 from = Vec2::Zero();
    ReliefPlace to{};
    bool follows_path = false;
  };
  // `leap`: m, how far it went in the world.
  void follow(Side& side, const ReliefPlace& to, double leap);
  void follow(const ContactEvent& point);
  void find_gains(const Vec3& direction, std::span<float> Side::*gains);
  HalfSine shape_of(double impulse, double start) const;
  void blow(const Vec3& impulse, double start);
  void find_radius();
  MesoWalk walk(const Side& side, double mass);
  void cross_texels(double now);
  double place_within();
  void rub(const ContactEvent& point);

  Ensemble& ensemble_;
  SynthesizerOptions options_;
  std::array<Side, 2> sides_;
  // Effective, of Hertz contact; rebound is 1 + restitution.
  double mass_ = 1, radius_ = 1, modulus_ = 1, rebound_ = 1;
  Random random_{0};
  ContactForce force_;

  ContactStep step_;       // being gathered
  ContactStep last_step_;  // finished
  bool is_touching_ = false;
  Vec3 place_ = Vec3::Zero();  // of the contact, the last time
  std::array<MesoImpulse, 256> crossings_;
  Rubbing rubbing_;
  std::array<float, block_samples> noise_;
  std::uint64_t truncated_paths_ = 0;
};

}  // namespace intaglio::sound
