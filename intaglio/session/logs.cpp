#include "intaglio/session/logs.h"

#include <array>

namespace intaglio::session {

namespace {

std::string columns(const Vec3& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

}  // namespace

std::string events_csv(const Recording& recording) {
  constexpr std::array<const char*, 3> phases{"begin", "persist", "end"};
  std::string out =
      "time_s,body,phase,x_m,y_m,z_m,u,v,n_gx,n_gy,n_gz,n_sx,n_sy,n_sz,v_tx_m_s,v_ty_m_s,v_tz_m_s,impulse_x_"
      "N_s,impulse_y_N_s,impulse_z_N_s\n";
  for (const ContactEvent& e : recording.events) {
    out += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", e.time, e.body,
                       phases[static_cast<std::size_t>(e.phase)], columns(e.point), e.uv.x(), e.uv.y(),
                       columns(e.n_g), columns(e.n_s), columns(e.v_t), columns(e.impulse));
  }
  return out;
}

std::string servo_csv(const Recording& recording) {
  std::string out =
      "time_s,tip_x_m,tip_y_m,tip_z_m,u,v,surface_height_m,n_sx,n_sy,n_sz,touching,force_x_N,force_y_N,force_"
      "z_N,wanted_x_N,wanted_y_N,wanted_z_N,guard_status\n";
  for (std::size_t k = 0; k < recording.servo.size(); ++k) {
    const haptics::ServoSample& s = recording.servo[k];
    out += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", static_cast<double>(k) / recording.servo_rate,
                       columns(s.tip), s.uv.x(), s.uv.y(), s.surface_height, columns(s.n_s),
                       s.touching ? 1 : 0, columns(s.force), columns(s.wanted), s.guard_status);
  }
  return out;
}

}  // namespace intaglio::session
