#include "session/recording.h"

#include <sys/resource.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "haptics/haptic_log.h"

namespace intaglio::session {

std::int64_t cpu_ns(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return std::int64_t(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

std::int64_t thread_cpu_ns() {
  return cpu_ns(CLOCK_THREAD_CPUTIME_ID);
}
std::int64_t process_cpu_ns() {
  return cpu_ns(CLOCK_PROCESS_CPUTIME_ID);
}

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::size_t(usage.ru_maxrss) * 1024;
}

SenseCost CostMeter::summarise(SenseCost cost) const {
  cost.steps = ns_.size();
  if (ns_.empty()) return cost;
  std::vector<std::int64_t> sorted = ns_;
  std::sort(sorted.begin(), sorted.end());
  const auto quantile = [&](double q) {
    return double(sorted[std::size_t(q * double(sorted.size() - 1))]) * 1e-3;
  };
  cost.median_us = quantile(0.5);
  cost.p99_us = quantile(0.99);
  cost.total_s = double(std::accumulate(ns_.begin(), ns_.end(), std::int64_t{0})) * 1e-9;
  return cost;
}

namespace {

std::string columns(const Vec3& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

// Empty for NaN.
std::string column(double x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "";
}

}  // namespace

std::string events_csv(const Recording& recording) {
  constexpr std::array<const char*, 3> phases{"begin", "persist", "end"};
  std::string out =
      "time_s,body,phase,x_m,y_m,z_m,u,v,n_gx,n_gy,n_gz,n_sx,n_sy,n_sz,v_tx_m_s,v_ty_m_s,v_tz_m_s,impulse_x_"
      "N_s,impulse_y_N_s,impulse_z_N_s,other,spin_x_m_s,spin_y_m_s,spin_z_m_s,duration_s,touch_age_s\n";
  for (const ContactEvent& e : recording.events) {
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", e.time, e.body,
                       phases[std::size_t(e.phase)], columns(e.point), e.uv.x(), e.uv.y(), columns(e.n_g),
                       columns(e.n_s), columns(e.v_t), columns(e.impulse), e.other, columns(e.spin),
                       e.duration, column(e.touch_age));
  }
  return out;
}

std::string servo_csv(const Recording& recording) {
  return haptics::encode_log(recording.servo_rate, recording.texture,
                             recording.surface ? haptics::fingerprint(*recording.surface) : 0,
                             recording.servo);
}

}  // namespace intaglio::session
