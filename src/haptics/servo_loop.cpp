#include "haptics/servo_loop.h"

#include <fmt/format.h>
#include <pthread.h>
#include <time.h>

#include <cmath>
#include <cstring>

namespace intaglio::haptics {

namespace {

constexpr int fifo_priority = 70;

double monotonic() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

void sleep_until(double seconds) {
  const double floor = std::floor(seconds);
  const timespec t{time_t(floor), long((seconds - floor) * 1e9)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace

ServoLoop::ServoLoop(PenServo servo, Device& device)
    : servo_(std::move(servo)), device_(device), start_time_(monotonic()) {}

ServoLoop::~ServoLoop() {
  stop();
}

double ServoLoop::now() const {
  return monotonic() - start_time_;
}

void ServoLoop::start() {
  if (running_.exchange(true)) return;
  thread_ = std::thread([this] { run(); });
}

void ServoLoop::stop() {
  if (!running_.exchange(false)) return;
  thread_.join();
}

void ServoLoop::publish(SceneSnapshot scene) {
  scene.time = now();
  scene_.publish(scene);
}

std::string ServoLoop::priority() const {
  const int error = scheduling_.load(std::memory_order_acquire);
  if (error < 0) return "servo thread not started";
  if (error == 0) return fmt::format("servo thread runs SCHED_FIFO at priority {}", fifo_priority);
  return fmt::format(
      "servo thread runs at normal priority ({}); expect late ticks under load: allow SCHED_FIFO with "
      "'ulimit -r {}' or CAP_SYS_NICE",
      std::strerror(error), fifo_priority);
}

void ServoLoop::tick(double time) {
  if (rearm_.exchange(false, std::memory_order_acq_rel)) servo_.rearm();
  servo_.tick(device_, scene_.fetch(), time);
  report_.publish(servo_.report());
}

void ServoLoop::run() {
  sched_param scheduling{};
  scheduling.sched_priority = fifo_priority;
  scheduling_.store(pthread_setschedparam(pthread_self(), SCHED_FIFO, &scheduling),
                    std::memory_order_release);
  const double period = 1 / servo_.options().rate, first = now();
  std::uint64_t index = 0;
  while (running_.load(std::memory_order_acquire)) {
    const double due = first + double(index) * period;
    sleep_until(start_time_ + due);
    const double woken = now();
    wake_up_.add(woken - due);
    tick(woken);
    const double done = now();
    compute_.add(done - woken);
    const auto next = std::max(index + 1, std::uint64_t(std::ceil((done - first) / period)));
    skipped_ticks_.store(skipped_ticks_.load(std::memory_order_relaxed) + next - index - 1,
                         std::memory_order_relaxed);
    index = next;
  }
  servo_.release(device_);
}

}  // namespace intaglio::haptics
