// Laws of rendering: the same bits however the output is divided and on every processor, no allocation and no
// lock, and no click when a voice is stolen.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>

#include "core/portable_math.h"
#include "sound/modal_bank.h"
#include "sound/synthesizer.h"
#include "tests/count_allocations.h"
#include "tests/count_locks.h"
#include "tests/sound/scenes.h"

using namespace intaglio;
using namespace intaglio::sound;
using test::rate;
using test::tau;

namespace {

// 100 modes, driven by two drives that start within the block, rung out to sleep, and driven again.
std::vector<float> ring_cut(std::size_t cut) {
  Random random(2);
  std::vector<Resonator> modes;
  for (int m = 0; m < 100; ++m) {
    const double omega = tau * random.uniform(20, 18'000);
    modes.push_back({omega, omega * random.uniform(0.02, 0.5), random.uniform()});
  }
  ModalBank bank(modes, rate);
  std::vector<float> gains(std::size_t(bank.padded_modes())), others(gains), impulse, out(20'000);
  for (std::size_t m = 0; m < 100; ++m) {
    gains[m] = float(random.uniform(-1, 1));
    others[m] = float(random.uniform(-1, 1));
  }
  for (std::size_t k = 0; k < out.size(); ++k)
    impulse.push_back(k % 9000 < 700 ? float(random.uniform()) : 0);
  for (std::size_t done = 0; done < out.size();) {
    const std::size_t length = std::min({cut, block_samples - done % block_samples, out.size() - done});
    const std::span<const float> now = std::span(impulse).subspan(done, length);
    std::vector<Drive> drives;
    if (std::any_of(now.begin(), now.end(), [](float x) { return x != 0; }))
      drives.push_back({gains, now, 0});
    // The second one begins and ends somewhere within blocks.
    const std::size_t from = std::clamp<std::size_t>(77, done, done + length) - done,
                      to = std::clamp<std::size_t>(171, done, done + length) - done;
    if (from < to) drives.push_back({others, now.subspan(from, to - from), int(from)});
    bank.process(drives, std::span(out).subspan(done, length));
    done += length;
    if (done % block_samples == 0) bank.sleep_when_silent();
  }
  return out;
}

std::vector<float> play_cut(MesoSource meso, std::size_t cut) {
  Synthesizer synthesizer({.meso = meso}, test::bodies());
  for (const ContactEvent& event : test::tumble()) synthesizer.push(event);
  std::vector<float> out(44'100);
  for (std::size_t done = 0; done < out.size(); done += cut)
    synthesizer.render(std::span(out).subspan(done, std::min(cut, out.size() - done)));
  return out;
}

}  // namespace

TEST_CASE("the same bits for blocks of 1, 16, 64, 441 and 512 samples") {
  const std::vector<float> bank = ring_cut(64);
  CHECK(*std::max_element(bank.begin(), bank.end()) > 1);
  CHECK(bank.back() != 0);
  for (const std::size_t cut : {1, 16, 441, 512}) CHECK(ring_cut(cut) == bank);
  for (const MesoSource meso : {MesoSource::engine_impulses, MesoSource::normal_map}) {
    const std::vector<float> whole = play_cut(meso, 44'100);
    for (const std::size_t cut : {1, 16, 64, 441, 512}) CHECK(play_cut(meso, cut) == whole);
  }
}

TEST_CASE("the same bits with every instruction set of this machine") {
  const std::vector<float> best = ring_cut(64);
  const std::vector<std::string> targets = ring_targets();
  CHECK(!targets.empty());
  for (const std::string& target : targets) {
    CAPTURE(target);
    use_ring_target(target);
    CHECK(ring_cut(64) == best);
    CHECK(play_cut(MesoSource::engine_impulses, 441) == play_cut(MesoSource::engine_impulses, 64));
  }
  use_best_ring_target();
}

TEST_CASE("no allocation and no lock in a million blocks (fewer without INTAGLIO_SLOW)") {
  const int blocks = std::getenv("INTAGLIO_SLOW") ? 1'000'000 : 20'000;
  std::mutex mutex;
  const std::size_t locks_before = locks();
  mutex.lock();
  mutex.unlock();
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  CHECK(locks() == locks_before + 1);  // so that the count can fail
#endif
  Synthesizer synthesizer({.meso = MesoSource::normal_map, .max_pulses = 64, .max_modes = 32},
                          test::bodies());
  std::array<float, 2 * block_samples> out;
  const std::size_t allocations_before = allocations(), locks_after = locks();
  int k = 0;
  for (int block = 0; block < blocks; ++block) {
    // A slide, a lift-off, a pause: two seconds, again and again.
    while (k * test::step < synthesizer.time() + 0.01) {
      ++k;
      const int within = k % 960;
      if (within < 700)
        synthesizer.push(test::contact(k, 0.001 * (1 + within % 7), 0.4,
                                       within == 0 ? ContactPhase::begin : ContactPhase::persist));
      if (within == 700) synthesizer.push(test::contact(k, 0, 0, ContactPhase::end));
    }
    synthesizer.render_stereo(out);
  }
  // Both are computed before either is reported: printing a success takes a lock.
  const std::size_t allocated = allocations() - allocations_before, locked = locks() - locks_after;
  CHECK(allocated == 0);
  CHECK(locked == 0);
  CHECK(synthesizer.status().stolen_groups > 0);
}

TEST_CASE("a stolen voice dies away smoothly, and the loudest stay") {
  // Two groups of modes at 500 Hz: one loud, one a tenth as loud.
  std::vector<Resonator> modes(2 * resonator_lanes, Resonator{tau * 500, 1, 1.0 / resonator_lanes});
  ModalBank bank(modes, rate);
  std::vector<float> gains(modes.size(), 1.0f);
  std::fill_n(gains.begin(), resonator_lanes, 0.1f);
  const float blow = 1;
  const std::array<Drive, 1> drive{{{gains, std::span(&blow, 1), 0}}};
  std::vector<float> out(64 * 100);
  for (std::size_t block = 0; block < 100; ++block) {
    if (block == 30) bank.fade(bank.loudness(0) < bank.loudness(1) ? 0 : 1);
    bank.process(block == 0 ? std::span<const Drive>(drive) : std::span<const Drive>(),
                 std::span(out).subspan(64 * block, 64));
    bank.sleep_when_silent();
  }
  CHECK_FALSE(bank.is_sounding(0));
  CHECK(bank.is_sounding(1));
  // A pure tone obeys x[n+1] + x[n-1] = 2 cos(w) x[n]; a click is what breaks that.
  const auto click = [&](std::size_t from, std::size_t to) {
    float most = 0;
    for (std::size_t n = from; n < to; ++n)
      most =
          std::max(most, std::abs(out[n + 1] + out[n - 1] - 2 * float(std::cos(tau * 500 / rate)) * out[n]));
    return most;
  };
  const float tone = 0.1f, phase_step = float(tau * 500 / rate);
  CHECK(click(64 * 29, 64 * 60) <
        0.3f * tone * phase_step);  // cut off at once it would be about tone * phase_step or more
  CHECK(*std::max_element(out.end() - 200, out.end()) == doctest::Approx(1).epsilon(0.2));
}
