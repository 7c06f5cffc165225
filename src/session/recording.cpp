#include "session/recording.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace intaglio::session {

void Recording::on_step(std::span<const Vec3> positions) {
  tracks.resize(positions.size());
  for (std::size_t k = 0; k < positions.size(); ++k) tracks[k].push_back(positions[k]);
}

void Recording::on_sound(std::span<const float> block) {
  stereo.insert(stereo.end(), block.begin(), block.end());
  for (std::size_t k = 0; k < block.size(); k += 2) audio.push_back(0.5f * (block[k] + block[k + 1]));
}

void Recording::play_back(Observer& observer) const {
  for (const ContactEvent& event : events) observer.on_event(event);
  for (const haptics::ServoSample& sample : servo) observer.on_tick(sample);
  std::vector<Vec3> positions;
  const std::size_t steps = tracks.empty() ? 0 : tracks.front().size();
  for (std::size_t step = 0; step < steps; ++step) {
    positions.clear();
    for (const std::vector<Vec3>& track : tracks) positions.push_back(track[step]);
    observer.on_step(positions);
  }
  for (const float sample : audio) {
    const std::array both{sample, sample};
    observer.on_sound(both);
  }
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

const std::string_view event_columns =
    "time_s,body,phase,x_m,y_m,z_m,u,v,n_gx,n_gy,n_gz,n_sx,n_sy,n_sz,v_tx_m_s,v_ty_m_s,v_tz_m_s,impulse_x_"
    "N_s,impulse_y_N_s,impulse_z_N_s,other,spin_x_m_s,spin_y_m_s,spin_z_m_s,duration_s,touch_age_s\n";

std::string event_row(const ContactEvent& e) {
  constexpr std::array<const char*, 3> phases{"begin", "persist", "end"};
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", e.time, e.body,
                     phases[std::size_t(e.phase)], columns(e.point), e.uv.x(), e.uv.y(), columns(e.n_g),
                     columns(e.n_s), columns(e.v_t), columns(e.impulse), e.other, columns(e.spin), e.duration,
                     column(e.touch_age));
}

std::string events_csv(const Recording& recording) {
  std::string out(event_columns);
  for (const ContactEvent& event : recording.events) out += event_row(event);
  return out;
}

}  // namespace intaglio::session
