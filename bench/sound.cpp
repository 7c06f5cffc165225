// How many modes ring in real time: bench_sound [--json] [MODES].
//
// Every row plays MODES modes (80,000 by default) at 44.1 kHz in blocks of 64, each block driven by noise of
// its own, and says how many modes the thread could play in real time: MODES times the time played over the
// thread's CPU time, median and worst hundredth (p99) of blocks. `banks` are bodies of 100 modes each, as a
// session has them; `one bank` is a body with all of them. Beside them, in the same run: each instruction set
// of this machine; the same arithmetic as plain loops; and STK's Modal (biquads in double,
// one sample a call), where libstk was installed at build time. Then what a session's parts cost: a strike, a
// block of the synthesizer with sliding contacts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#ifdef INTAGLIO_HAS_STK
#include <stk/Modal.h>
#include <stk/Stk.h>
#endif

#include "bench/brick.h"
#include "core/portable_math.h"
#include "sound/denormals.h"
#include "sound/modal_bank.h"
#include "tests/sound/scenes.h"

using namespace intaglio;
using namespace intaglio::sound;
using bench::cpu_seconds;

namespace {

constexpr double rate = 44'100;
constexpr double block_seconds = block_samples / rate;
volatile float sink = 0;

struct Row {
  std::string what;
  double median, p99;  // of the same unit
  std::string unit;
};

std::vector<Resonator> some_modes(int count) {
  Random random(3);
  std::vector<Resonator> list;
  for (int m = 0; m < count; ++m) {
    const double omega = 2 * std::numbers::pi * 20 * std::pow(900, random.uniform());
    list.push_back({omega, random.uniform(2, 60), random.uniform(0.1, 1)});
  }
  return list;
}

std::vector<float> noise(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> out;
  for (int k = 0; k < count; ++k) out.push_back(float(random.uniform(-1, 1)));
  return out;
}

// Seconds of CPU time a block.
std::vector<double> time_blocks(int blocks, const std::function<void()>& block) {
  for (int k = 0; k < 10; ++k) block();
  std::vector<double> times;
  for (int k = 0; k < blocks; ++k) {
    const double start = cpu_seconds();
    block();
    times.push_back(cpu_seconds() - start);
  }
  std::sort(times.begin(), times.end());
  return times;
}

Row modes_row(const std::string& what, int modes, const std::vector<double>& times) {
  const auto in_real_time = [&](double seconds) { return modes * block_seconds / seconds; };
  return {what, in_real_time(times[times.size() / 2]), in_real_time(times[times.size() * 99 / 100]), "modes"};
}

Row banks_row(const std::string& what, int modes, int modes_each, bool is_driven, int blocks) {
  std::vector<ModalBank> banks;
  const auto list = some_modes(modes);
  for (int m = 0; m < modes; m += modes_each)
    banks.emplace_back(std::span(list).subspan(std::size_t(m), std::size_t(std::min(modes_each, modes - m))),
                       rate);
  const std::vector<float> gains = noise(banks[0].padded_modes(), 5), impulse = noise(block_samples, 7);
  const std::array<Drive, 1> drive{{{gains, impulse, 0}}};
  std::vector<float> out(block_samples);
  for (ModalBank& bank : banks) bank.process(drive, out);
  return modes_row(what, modes, time_blocks(blocks, [&] {
                     for (ModalBank& bank : banks) {
                       bank.process(is_driven ? std::span<const Drive>(drive) : std::span<const Drive>(),
                                    out);
                       bank.sleep_when_silent();
                     }
                     sink = sink + out[0];
                   }));
}

// The same arithmetic as plain loops: mode after mode, or all modes sample after sample, which a compiler may
// turn into SIMD.
class PlainBank {
 public:
  explicit PlainBank(int modes) : re_(std::size_t(modes)), im_(re_) {
    const std::vector<float> gains = noise(modes, 5);
    for (std::size_t m = 0; const Resonator& r : some_modes(modes)) {
      const double angle = r.angular_frequency / rate, shrink = std::exp(-r.damping / rate);
      turn_re_.push_back(float(shrink * std::cos(angle)));
      turn_im_.push_back(float(shrink * std::sin(angle)));
      gain_re_.push_back(gains[m] * float(r.radiation));
      gain_im_.push_back(gains[m++] * float(r.radiation * r.damping / r.angular_frequency));
    }
  }
  void mode_after_mode(const float* impulse, float* out) {
    for (std::size_t m = 0; m < re_.size(); ++m) {
      float re = re_[m], im = im_[m];
      for (std::size_t n = 0; n < block_samples; ++n) {
        ring(m, impulse[n], re, im);
        out[n] += re;
      }
      re_[m] = re;
      im_[m] = im;
    }
  }
  void sample_after_sample(const float* impulse, float* out) {
    for (std::size_t n = 0; n < block_samples; ++n) {
      float sum = 0;
      for (std::size_t m = 0; m < re_.size(); ++m) {
        ring(m, impulse[n], re_[m], im_[m]);
        sum += re_[m];
      }
      out[n] += sum;
    }
  }

 private:
  void ring(std::size_t m, float impulse, float& re, float& im) const {
    const float before = re;
    re = turn_re_[m] * before - turn_im_[m] * im + gain_re_[m] * impulse;
    im = turn_re_[m] * im + turn_im_[m] * before + gain_im_[m] * impulse;
  }
  std::vector<float> re_, im_, turn_re_, turn_im_, gain_re_, gain_im_;
};

Row plain_row(const std::string& what, int modes, int blocks, void (PlainBank::*play)(const float*, float*)) {
  PlainBank bank(modes);
  const std::vector<float> impulse = noise(block_samples, 7);
  std::vector<float> out(block_samples);
  return modes_row(what, modes, time_blocks(blocks, [&] {
                     const DenormalsAreZero guard;
                     (bank.*play)(impulse.data(), out.data());
                     sink = sink + out[0];
                   }));
}

#ifdef INTAGLIO_HAS_STK
// Modal is abstract; what it plays is a wave file, of which it has none here, so its filters ring.
class StkModes : public stk::Modal {
 public:
  explicit StkModes(unsigned modes) : Modal(modes) {
    wave_ = new stk::FileWvIn();
    for (unsigned k = 0; k < modes; ++k) {
      setRatioAndRadius(k, 1 + k, 0.9999);
      setModeGain(k, 0.5);
    }
    setFrequency(100);
    for (unsigned k = 0; k < modes; ++k) filters_[k]->tick(1.0);
  }
  ~StkModes() override { delete wave_; }
  void controlChange(int, stk::StkFloat) override {}
};

Row stk_row(int modes, int blocks) {
  stk::Stk::setSampleRate(rate);
  stk::Stk::showWarnings(false);
  constexpr int each = 100;
  std::vector<std::unique_ptr<StkModes>> bodies;
  for (int m = 0; m < modes; m += each) bodies.push_back(std::make_unique<StkModes>(each));
  return modes_row("STK 4.6 Modal, banks of 100", modes, time_blocks(blocks, [&] {
                     double sum = 0;
                     for (auto& body : bodies) {
                       for (int n = 0; n < block_samples; ++n) sum += body->tick();
                     }
                     sink = sink + float(sum);
                   }));
}
#endif

Row strike_row() {
  const auto model = sound::test::small_slab();
  ModalBank bank(*model, rate);
  std::vector<float> gains(std::size_t(bank.padded_modes()));
  Random random(1);
  auto times = time_blocks(2000, [&] {
    model->gains({random.uniform(-0.25, 0.25), 0.015, random.uniform(-0.25, 0.25)}, Vec3::UnitY(),
                 std::span(gains).first(std::size_t(bank.modes())));
    sink = sink + gains[0];
  });
  return {"gains of a strike, 40 modes", times[times.size() / 2] * 1e6, times[times.size() * 99 / 100] * 1e6,
          "us"};
}

Row session_row(MesoSource meso, const std::string& what) {
  Synthesizer synthesizer({.meso = meso}, sound::test::bodies());
  Random random(4);
  for (int k = 1; k < 4000; ++k)
    synthesizer.push(sound::test::contact(k, 0.001 * (1 + random.uniform()), 0.4,
                                          k == 1 ? ContactPhase::begin : ContactPhase::persist));
  std::vector<float> out(2 * block_samples);
  auto times = time_blocks(5000, [&] { synthesizer.render_stereo(out); });
  return {what, times[times.size() / 2] * 1e6, times[times.size() * 99 / 100] * 1e6, "us"};
}

void print(const std::vector<Row>& rows, int modes, bool json) {
  if (json)
    fmt::print("{{\"modes\": {}, \"sample_rate\": {}, \"block\": {}, \"rows\": [\n", modes, rate,
               block_samples);
  if (!json)
    fmt::print("{:<52}{:>12}{:>12}\n", fmt::format("{} modes, blocks of {}", modes, block_samples), "median",
               "p99");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& r = rows[k];
    if (json) {
      fmt::print("  {{\"what\": \"{}\", \"median\": {:.6g}, \"p99\": {:.6g}, \"unit\": \"{}\"}}{}\n", r.what,
                 r.median, r.p99, r.unit, k + 1 < rows.size() ? "," : "");
    } else {
      fmt::print("{:<52}{:>12.5g}{:>12.5g} {}\n", r.what, r.median, r.p99, r.unit);
    }
  }
  if (json) fmt::print("]}}\n");
}

}  // namespace

int main(int argc, char** argv) {
  bool json = false;
  int modes = 80'000;
  for (int k = 1; k < argc; ++k) {
    if (std::string(argv[k]) == "--json") {
      json = true;
    } else if (const int count = std::atoi(argv[k]); count >= 100 && count <= 10'000'000) {
      modes = count;
    } else {
      fmt::print(stderr, "bench_sound: '{}' is neither --json nor a number of modes\n", argv[k]);
      return 2;
    }
  }
  std::vector<Row> rows;
  const int blocks = std::clamp(32'000'000 / modes, 20, 2000);
  rows.push_back(banks_row("banks of 100, driven", modes, 100, true, blocks));
  rows.push_back(banks_row("banks of 100, ringing", modes, 100, false, blocks));
  for (const std::string& target : ring_targets()) {
    use_ring_target(target);
    rows.push_back(banks_row("one bank, driven, " + target, modes, modes, true, blocks));
  }
  use_best_ring_target();
  rows.push_back(plain_row("plain loop, mode after mode", modes, blocks, &PlainBank::mode_after_mode));
  rows.push_back(
      plain_row("plain loop, sample after sample", modes, blocks / 2, &PlainBank::sample_after_sample));
#ifdef INTAGLIO_HAS_STK
  rows.push_back(stk_row(modes, std::max(20, blocks / 5)));
#endif
  rows.push_back(strike_row());
  rows.push_back(session_row(MesoSource::engine_impulses, "block of a sliding contact, engine impulses"));
  rows.push_back(session_row(MesoSource::normal_map, "block of a sliding contact, normal map"));
  print(rows, modes, json);
}
