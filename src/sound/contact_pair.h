// One pair of bodies in contact: gathers the points of a step, keeps what lasts from step to step, and turns
// both into strikes and noise.
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
  // An unassigned slot; assign() gives it two bodies.
  ContactPair(Ensemble& ensemble, const SynthesizerOptions& options);

  // Assigns the slot to two bodies, indices of the ensemble.
  void assign(int body, int other);

  int body() const { return sides_[0].body; }
  int other() const { return sides_[1].body; }
  bool is_touching() const { return is_touching_ || step_.duration > 0; }
  // Time of the last step, s. Meaningless before the first.
  double last_time() const { return last_step_.time; }

  // Takes one more event. If it belongs to a later step than the one being gathered, that one is finished
  // first.
  void add(const ContactEvent& event, double now);
  // Turns the gathered step into sound that begins no earlier than `now`.
  void finish_step(double now);
  // The contact has ended: the sustained impulse is released.
  void release(double now);
  // Drives the ensemble with the sustained noise for `samples` samples from `first`.
  void drive(std::int64_t first, std::size_t samples);

  std::uint64_t truncated_paths() const { return truncated_paths_; }

 private:
  // One of the two bodies: `body` receives the impulses as they are reported, `other` their opposite.
  struct Side {
    int body = -1;
    double sign = 1;
    std::vector<float> strike_storage, normal_storage;  // sized for the body with the most modes
    std::span<float> strike_gains{}, normal_gains{};    // of this body
    // Path of the contact over this body's texture during the step, when it continues from the last one.
    Vec2 from = Vec2::Zero();
    ReliefPoint to{};
    bool follows_path = false;
  };
  // `distance_moved`: by the contact in the world since the last step, m.
  void follow_path(Side& side, const ReliefPoint& to, double distance_moved);
  void update_paths(const ContactEvent& point);
  void find_gains(const ContactStep& step, const Vec3& direction, std::span<float> Side::*gains);
  HalfSine pulse_shape(double impulse, double start) const;
  void strike(const ContactStep& step, const Vec3& impulse, double start);
  void find_radius();
  MesoWalk walk(const Side& side, double mass);
  void cross_texels(double now);
  double strike_fraction();
  void update_rubbing(const ContactEvent& point);

  Ensemble& ensemble_;
  SynthesizerOptions options_;
  std::array<Side, 2> sides_;
  // Effective values of Hertz contact.
  double mass_ = 1, radius_ = 1, modulus_ = 1, one_plus_restitution_ = 1;
  Random random_{0};
  ImpulseSplitter splitter_;

  ContactStep step_;       // being gathered
  ContactStep last_step_;  // finished
  bool is_touching_ = false;
  Vec3 contact_point_ = Vec3::Zero();  // in the last step
  std::array<MesoImpulse, 256> crossings_;
  Rubbing rubbing_;
  std::array<float, block_samples> noise_;
  std::uint64_t truncated_paths_ = 0;
};

}  // namespace intaglio::sound
