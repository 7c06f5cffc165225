// The number of modes that sound at once, and the rate of the servo loop.
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "bench/brick.h"
#include "bench/scaling/law.h"
#include "bench/sliding_tip.h"
#include "core/portable_math.h"
#include "haptics/servo.h"
#include "sound/modal_bank.h"

namespace intaglio::bench {

namespace {

// Bodies of 100 modes each, every one driven by noise.
class Banks {
 public:
  explicit Banks(int modes) {
    Random random(3);
    for (int done = 0; done < modes; done += 100) {
      std::vector<sound::Resonator> list;
      for (int m = 0; m < 100; ++m) {
        const double omega = 2 * std::numbers::pi * 20 * std::pow(900, random.uniform());
        const double damping = random.uniform(2, 60);
        list.push_back({omega, damping, 1});
      }
      banks_.emplace_back(list, 44'100.0);
    }
    for (int m = 0; m < banks_[0].padded_modes(); ++m)
      gains_.push_back(m < 100 ? float(random.uniform(-1, 1)) : 0.0F);
    for (float& value : impulse_) value = float(random.uniform(-1, 1));
  }
  double block_us(int blocks) {
    const std::array<sound::Drive, 1> drive{{{gains_, impulse_, 0}}};
    const double start = cpu_seconds();
    for (int k = 0; k < blocks; ++k)
      for (sound::ModalBank& bank : banks_) bank.process(drive, out_);
    return 1e6 * (cpu_seconds() - start) / blocks;
  }

 private:
  std::vector<sound::ModalBank> banks_;
  std::vector<float> gains_;
  std::array<float, sound::block_samples> impulse_{}, out_{};
};

constexpr int seconds_of_servo = 4;

struct Servo {
  Servo(const std::shared_ptr<const surface::Surface>& s, double rate)
      : path(sliding_path(s, int(seconds_of_servo * rate), Representation::relief, rate)),
        device(path),
        servo(s, options(rate)) {}
  static haptics::ServoOptions options(double rate) {
    haptics::ServoOptions out;
    out.rate = rate;
    return out;
  }
  double share() {
    const double start = cpu_seconds();
    for (std::size_t k = 0; k < path.size(); ++k) servo.tick(device);
    return 100 * (cpu_seconds() - start) / seconds_of_servo;
  }
  std::vector<Vec3> path;
  LedDevice device;
  haptics::PenServo servo;
};

}  // namespace

Result<std::vector<Law>> scale_modes(const Effort& effort) {
  const std::vector<double> n = effort.quick
                                    ? std::vector<double>{100, 1000, 10'000}
                                    : std::vector<double>{100, 300, 1000, 3000, 10'000, 30'000, 100'000};
  std::vector<std::unique_ptr<Banks>> banks;
  for (const double modes : n) banks.push_back(std::make_unique<Banks>(int(modes)));
  for (const auto& bank : banks) bank->block_us(2);
  return std::vector<Law>{
      {"modes", "sound", "us a block of 64 samples, all driven", n,
       interleaved(n.size(), effort.quick ? 5 : 31,
                   [&](std::size_t k) { return banks[k]->block_us(int(1 + 30'000 / n[k])); }),
       64e6 / 44'100, "64 samples"}};
}

Result<std::vector<Law>> scale_servo_rate(const Effort& effort) {
  const std::vector<double> rates = {1000, 2000, 4000, 8000};
  const auto s = std::make_shared<const surface::Surface>(brick(512));
  std::vector<std::unique_ptr<Servo>> servos;
  for (const double rate : rates) servos.push_back(std::make_unique<Servo>(s, rate));
  return std::vector<Law>{
      {"servo rate, Hz", "touch", "% of a core", rates,
       interleaved(rates.size(), effort.quick ? 3 : 15, [&](std::size_t k) { return servos[k]->share(); }),
       100, "one core"}};
}

}  // namespace intaglio::bench
