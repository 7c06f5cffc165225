// All sounding bodies: their resonators, where they are, and the pulses that strike them.
//
// Internal to sound/. All memory is allocated at construction; nothing here allocates, locks or throws
// afterwards. One thread.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "sound/impact.h"
#include "sound/modal_bank.h"
#include "sound/rubbing.h"
#include "sound/synthesizer.h"

namespace intaglio::sound {

class Ensemble {
 public:
  Ensemble(std::vector<SoundBody> bodies, const SynthesizerOptions& options);

  int size() const { return int(bodies_.size()); }
  const SoundBody& body(int i) const { return bodies_[std::size_t(i)].body; }
  // The body's material, else the model's, else the default.
  const Material& material(int i) const;
  // The roughness of its material.
  const MicroNoise& noise(int i) const { return *bodies_[std::size_t(i)].micro; }
  // -1 when no body has that id.
  int find(BodyId id) const;
  void move(int i, const Pose& pose) { bodies_[std::size_t(i)].pose = pose; }
  // Fixed bodies radiate from the last touched point.
  void set_touch_point(int i, const Vec3& point);
  void set_listener(const Listener& listener) { listener_ = listener; }
  int padded_modes(int i) const { return bodies_[std::size_t(i)].padded_modes(); }
  int max_padded_modes() const;

  // Adds `weight` times the gains of body i for a push along `direction` at `point` (both world) to `out`, of
  // padded_modes(i).
  void add_gains(int i, const Vec3& point, const Vec3& direction, double weight, std::span<float> out);
  // Strikes body i with `impulse` (N s) times `gains`, of padded_modes(i), as a pulse.
  void strike(int i, std::span<const float> gains, const HalfSine& shape, double impulse);
  // Drives body i in the coming block; both spans must live until then.
  void drive(int i, const Drive& drive) { bodies_[std::size_t(i)].drives.push_back(drive); }
  // Room for that many sustained drives a block.
  void reserve_drives(std::size_t count);

  // Adds `samples` samples, at most block_samples and not beyond the next multiple of it, from number `first`
  // on to `out`: mono if out.size() == samples, interleaved stereo if twice that.
  void render(std::int64_t first, std::size_t samples, std::span<float> out);
  void sleep_when_silent();
  // Fades out the quietest modes beyond options.max_modes.
  void steal_quietest();
  std::uint64_t stolen_groups() const { return stolen_; }
  bool is_silent() const;
  std::uint64_t dropped_pulses() const { return pulses_.dropped(); }

 private:
  struct Member {
    Member(SoundBody b, const SynthesizerOptions& options, std::shared_ptr<const MicroNoise> noise);
    int padded_modes() const { return bank.empty() ? 0 : bank[0].padded_modes(); }

    SoundBody body;
    Pose pose;
    Vec3 source;                  // radiates from there
    EarGains ears_from, ears_to;  // at the two ends of the current block
    std::vector<ModalBank> bank;  // one, or none for a body that makes no sound
    int model_modes = 0;          // of the bank; one more is the click of a free body
    std::vector<Drive> drives;    // of the coming block
    std::shared_ptr<const MicroNoise> micro;
  };
  static std::vector<Member> members(std::vector<SoundBody> bodies, const SynthesizerOptions& options);
  // A group of modes of a body, and its loudness.
  struct Voice {
    float loudness;
    int body, group;
  };
  void update_ear_gains(std::int64_t first);
  void mix(const Member& member, std::int64_t first, std::span<const float> pascals,
           std::span<float> out) const;

  double sample_rate_;
  Listener listener_;
  std::vector<Member> bodies_;
  PulsePool pulses_;
  std::size_t max_groups_;
  std::vector<Voice> sounding_;  // reused by steal_quietest()
  std::uint64_t stolen_ = 0;
  std::vector<float> scratch_;                              // gains of one push
  std::vector<std::array<float, block_samples>> impulses_;  // of each pulse in the block
};

}  // namespace intaglio::sound
